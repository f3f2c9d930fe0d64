// The cost of watching a busy swarm with all tools at once.
#include "dash_server.hpp"
#include "measure.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <sstream>
#include <unistd.h>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

using Pids = std::vector<pid_t>;

/// Of the processes, and of the children that these have waited for.
double processor_s(const Pids& pids)
{
    double ticks = 0;
    for (const auto pid : pids) {
        const auto stat = text_of("/proc/" + std::to_string(pid) + "/stat");
        std::istringstream fields(stat.substr(stat.rfind(')') + 2));
        std::string field;
        for (int i = 3; i <= 17 && fields >> field; ++i)
            ticks += i >= 14 ? std::stod(field) : 0;
    }
    return ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

/// Scraped metrics, an open page, running audit and exceptions, and explain every three seconds.
class Watchers {
public:
    explicit Watchers(const Swarm& swarm) : page_(swarm)
    {
        requests_.push_back(page_.begin("/events"));
        const auto metrics = free_port();
        programs_.push_back(swarm.hivectl_running({"metrics", "--http", std::to_string(metrics)}, "metrics"));
        programs_.push_back(swarm.hivectl_running({"audit", "--watch"}, "audit"));
        programs_.push_back(swarm.hivectl_running({"exceptions", "--follow"}, "exceptions"));
        programs_.push_back(shell(swarm, "while :; do hivectl explain; sleep 3; done"));
        const auto again = [&](const std::string& curl, const char* seconds) {
            requests_.push_back(shell(swarm, "while :; do curl -s -m 5 " + curl + "; sleep " + seconds + "; done"));
        };
        again("http://127.0.0.1:" + std::to_string(metrics) + "/metrics", "1");
        again("-b " + page_.cookie() + " " + page_.address() + "/drone/worker-1 " + page_.address() + "/ask/worker-1",
              "2");
    }
    /// The processes of Hive; curl is a client that would run elsewhere.
    [[nodiscard]] Pids pids() const
    {
        Pids pids{page_.pid()};
        for (const auto& program : programs_)
            pids.push_back(program.pid());
        return pids;
    }

private:
    static Process shell(const Swarm& swarm, const std::string& line)
    {
        return {{"/bin/bash", "-c", line},
                {"HIVE_HOME=" + swarm.home().string(),
                 "HIVE_KEY=", "PATH=" + swarm.program("hivectl").parent_path().string() + ":/usr/bin:/bin"},
                swarm.home() / "requests"};
    }

    Page page_;
    std::vector<Process> requests_, programs_;
};

}  // namespace

TEST_CASE("watching: metrics, dash, audit, explain and exceptions at once cost a busy swarm less than 1 % of its rate "
          "and 2 % of the processors")
{
    if (!possible(missing_if_sanitized()))
        return;  // a measurement
    const Swarm swarm;
    std::vector<Process> drones;
    drones.push_back(swarm.drone("ticker", "source", {"pace=demand", "bytes=100000"}));
    auto application = swarm.application();
    std::vector<hive::Endpoint> results;
    for (const std::string worker : {"worker-1", "worker-2", "worker-3"}) {
        drones.push_back(swarm.drone("sleeper", worker, {"work_ms=40"}));
        application.connect({"source", ""}, {worker, ""}, {.window = 2, .group = "workers", .lease = {}});
        results.push_back({worker, "result"});
    }
    Pids pids;
    for (const auto& drone : drones)
        pids.push_back(drone.pid());
    const auto collector = application.collect(results);
    const auto measured = [&](const Pids& processes) {
        const auto used = processor_s(processes);
        const auto begin = Clock::now();
        const auto events = rate(*collector, 3, 75);
        const auto time = std::chrono::duration<double>(Clock::now() - begin).count();
        return std::pair(events, (processor_s(processes) - used) / time);
    };
    std::vector<double> ratios, costs, alone;
    for (int round = 0; round < 3; ++round) {
        rate(*collector, 3, 5);
        const auto [rate_alone, used_alone] = measured(pids);
        const Watchers watchers(swarm);
        rate(*collector, 3, 25);  // until they have started
        auto all = watchers.pids();
        all.insert(all.end(), pids.begin(), pids.end());
        const auto [rate_watched, used_watched] = measured(all);
        alone.push_back(rate_alone);
        ratios.push_back(rate_watched / rate_alone);
        costs.push_back((used_watched - used_alone) / static_cast<double>(::sysconf(_SC_NPROCESSORS_ONLN)));
    }
    MESSAGE("alone ", median(alone), " events/s; watched ", median(ratios), " of that, for ", 100 * median(costs),
            " % of the processors; load ", machine_load());
    // The change must not exceed the normal variation.
    const auto by_itself = *std::ranges::max_element(alone) / *std::ranges::min_element(alone) - 1;
    CHECK(median(ratios) > 0.99 - by_itself);
    CHECK(median(costs) < 0.02);
    const auto answers = text_of(swarm.home() / "requests");  // they did run
    for (const auto* answer : {"hive_drone_up", "data: {", "\"outputs\"", "\"interface\""})
        CHECK_MESSAGE(has(answers, answer), answer);
    CHECK(has(swarm.log("audit"), "worker-3"));
}
