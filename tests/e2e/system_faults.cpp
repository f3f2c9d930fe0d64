// Faults of the operating system: no descriptors, a port in use, a wall clock that is set. Slow, because each is
// observed for a while.
#include "free_port.hpp"
#include "measure.hpp"
#include "status_sums.hpp"
#include "wall_clock.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <cmath>
#include <fstream>
#include <vector>

#include <sys/resource.h>
#include <unistd.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;
namespace fs = std::filesystem;

namespace {

using Seconds = std::chrono::duration<double>;

/// Limits the descriptors of a process, or restores the limit.
rlimit limit_descriptors(pid_t pid, rlim_t most)
{
    rlimit before{};
    REQUIRE(::prlimit(pid, RLIMIT_NOFILE, nullptr, &before) == 0);
    const rlimit limit{most, before.rlim_max};
    REQUIRE(::prlimit(pid, RLIMIT_NOFILE, &limit, nullptr) == 0);
    return before;
}

/// The number that the next descriptor of a process will have.
rlim_t next_descriptor(pid_t pid)
{
    rlim_t number = 0;
    while (fs::is_symlink("/proc/" + std::to_string(pid) + "/fd/" + std::to_string(number)))
        ++number;
    return number;
}

/// Processor time that the threads of a process have used.
Seconds processor_time(pid_t pid)
{
    Seconds sum{};
    for (const auto& thread : fs::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
        std::int64_t nanoseconds = 0;
        std::ifstream(thread.path() / "schedstat") >> nanoseconds;
        sum += std::chrono::nanoseconds(nanoseconds);
    }
    return sum;
}

hive::Ledger account_of(hive::Application& application, const std::string& receiver)
{
    return edge_to(application.status("ticker"), receiver).events;
}

}  // namespace

TEST_CASE("descriptors: a drone that has none left does not spin, goes on with its streams, and is soon as before")
{
    const Swarm swarm;
    const auto ticker = swarm.drone("ticker", "ticker", {"fps=100"}), counter = swarm.drone("counter", "counter");
    swarm.hivectl_done({"connect", "ticker", "counter", "--stream"});
    auto application = swarm.application();  // is connected, so it can ask
    REQUIRE(eventually([&] { return account_of(application, "counter.tick").of(hive::Fate::acknowledged) > 10; }));
    const auto used = [&](Seconds time) {
        const auto begin = Clock::now();
        const auto before = processor_time(ticker.pid());
        std::this_thread::sleep_for(time);  // this is the measurement
        return (processor_time(ticker.pid()) - before) / Seconds(Clock::now() - begin);
    };
    const auto usual = used(2s);

    const auto none_left = next_descriptor(ticker.pid());
    std::vector<double> exhausted;
    std::vector<Seconds> normal;
    for (const std::string name : {"first", "second", "third"}) {
        CAPTURE(name);
        REQUIRE(eventually([&] { return next_descriptor(ticker.pid()) == none_left; }));  // the one before has left
        const auto before_exhaustion = limit_descriptors(ticker.pid(), none_left);
        const auto before = account_of(application, "counter.tick");
        auto newcomer = swarm.hivectl_running({"get", "ticker", "fps", "--timeout", "20"}, name);  // not accepted
        exhausted.push_back(used(1s));
        hive::Ledger after;
        std::int64_t came = 0, kept = 0;
        CHECK(eventually([&] {
            after = account_of(application, "counter.tick");
            came = after.total() - before.total();
            kept = after.of(hive::Fate::acknowledged) - before.of(hive::Fate::acknowledged);
            return kept >= came - 32;  // acknowledged together
        }));
        CHECK_FALSE(newcomer.wait(0ms));

        limit_descriptors(ticker.pid(), before_exhaustion.rlim_cur);
        const auto returned = Clock::now();
        CHECK(newcomer.wait(patient(5000ms)) == 0);
        normal.push_back(Clock::now() - returned);
        MESSAGE("processor " << 100 * usual << " % before, " << 100 * exhausted.back() << " % without descriptors; "
                             << kept << " of " << came << " events were received meanwhile; as before after "
                             << normal.back().count() << " s");
        CHECK(came >= 50);
        CHECK(after.of(hive::Fate::dropped) == before.of(hive::Fate::dropped));
        CHECK(swarm.log(name) == "100.0\n");
    }
    if (!sanitized())
        CHECK(median(exhausted) <= usual + 0.02);
    CHECK(median(normal) < stated(1000ms));
}

TEST_CASE(
    "port: a drone whose port is in use ends at once with exit code 1, and says which port that is and who has it")
{
    const Swarm swarm;
    const auto port = std::to_string(free_port());
    const std::vector<std::string> there{"--listen", "tcp://127.0.0.1:" + port, "--insecure"};
    const auto first = swarm.drone("ticker", "first", {}, there);
    const auto second =
        swarm.run({swarm.program("hive-ticker").string(), "--name", "second", there[0], there[1], there[2]});
    MESSAGE("exit code " << second.exit_code << " after " << second.took.count() / 1000 << " ms: " << second.err);
    CHECK(second.exit_code == 1);
    CHECK(second.took < patient(1000ms));
    CHECK(has(second.err, "port " + port + " is taken by hive-ticker, process " + std::to_string(first.pid())));
    const auto started = swarm.hivectl({"start", "ticker", "--as", "second", there[0], there[1], there[2]});
    CHECK(started.exit_code != 0);
    CHECK(has(started.err, "port " + port + " is taken"));
    CHECK(swarm.application().drones() == std::vector<std::string>{"first"});
}

TEST_CASE("port: when ports may be shared, a second drone at the port of the first is not refused")
{
    const std::vector<std::string> shared{"HIVE_TEST_WITHOUT=own-port"};
    const Swarm swarm;
    const std::vector<std::string> there{"--listen", "tcp://127.0.0.1:" + std::to_string(free_port()), "--insecure"};
    const auto first = swarm.drone("ticker", "first", {}, there, shared),
               second = swarm.drone("ticker", "second", {}, there, shared);
    CHECK(swarm.application().drones() == std::vector<std::string>{"first", "second"});
}

TEST_CASE("clock: a wall clock that jumps an hour either way ends no connection and no lease")
{
    if (!possible(WallClock::missing()))
        return;
    const Swarm swarm;
    const WallClock clock(swarm.home());
    const auto ticker = swarm.drone("ticker", "ticker", {"fps=50"}, {}, clock.environment());
    const auto alone = swarm.drone("sleeper", "alone", {}, {});
    const auto one = swarm.drone("sleeper", "one", {"work_ms=50"}), two = swarm.drone("sleeper", "two", {"work_ms=50"});
    swarm.hivectl_done({"connect", "ticker", "alone", "--stream"});
    swarm.hivectl_done({"connect", "ticker", "one", "two", "--share"});
    auto application = swarm.application();
    const auto registrations = [&] {
        std::int64_t sum = 0;
        for (const auto& edge : application.status("ticker").outputs.at(0).edges)
            sum += edge.registration;
        return sum;
    };
    const auto received = [&] { return at_inputs(application.status("alone"), &hive::InputStatus::received); };
    REQUIRE(eventually([&] { return received() > 10; }));
    const auto registered = registrations();
    for (const std::string offset : {"+3600", "-3600", "+0"}) {
        CAPTURE(offset);
        clock.set(offset);
        const auto apart = [&] {
            return std::abs(application.status("alone").inputs.at(0).last_age_us) / 3'000'000'000;
        };
        CHECK(eventually([&] { return apart() == (offset == "+0" ? 0 : 1); }));
        const auto before = received();
        const auto begin = Clock::now();
        CHECK(eventually([&] { return received() >= before + 150; }, 8000ms));
        MESSAGE("150 events at 50 a second after the clock was set to "
                << offset << " s took " << Seconds(Clock::now() - begin).count() << " s");
        CHECK(swarm.hivectl({"set", "ticker", "fps=50"}).exit_code == 0);
    }
    CHECK(registrations() == registered);
    for (const auto& edge : application.status("ticker").outputs.at(0).edges) {
        CHECK(edge.events.lost() == 0);
        CHECK(edge.events.of(hive::Fate::passed_on) == 0);
    }
    for (const auto* worker : {"one", "two"})
        CHECK(at_inputs(application.status(worker), &hive::InputStatus::duplicates) == 0);
}

TEST_CASE("clock: when leases go by the wall clock, one that jumps ends them")
{
    if (!possible(WallClock::missing()))
        return;
    const Swarm swarm;
    const WallClock clock(swarm.home());
    auto environment = clock.environment();
    environment.emplace_back("HIVE_TEST_WITHOUT=steady-clock");
    const auto ticker = swarm.drone("ticker", "ticker", {"fps=50"}, {}, environment);
    const auto one = swarm.drone("sleeper", "one", {"work_ms=500"}),
               two = swarm.drone("sleeper", "two", {"work_ms=500"});
    swarm.hivectl_done({"connect", "ticker", "one", "two", "--share"});
    auto application = swarm.application();
    const auto passed_on = [&] {
        std::int64_t sum = 0;
        for (const auto& edge : application.status("ticker").outputs.at(0).edges)
            sum += edge.events.of(hive::Fate::passed_on);
        return sum;
    };
    REQUIRE(eventually([&] { return at_inputs(application.status("one"), &hive::InputStatus::received) > 0; }));
    CHECK(passed_on() == 0);
    clock.set("+3600");
    CHECK(eventually([&] { return passed_on() > 0; }));
}
