// A supervising `up`: crashed drones restart with their connections, and nothing else delays that.
#include "status_sums.hpp"
#include "worker_swarm.hpp"

#include <doctest/doctest.h>
#include <hive/event/home.hpp>

#include <algorithm>
#include <csignal>
#include <random>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// Zombie children.
std::size_t zombies_of(pid_t parent)
{
    const auto number = std::to_string(parent), children = text_of("/proc/" + number + "/task/" + number + "/children");
    std::istringstream pids(children);
    std::size_t count = 0;
    for (std::string pid; pids >> pid;)
        count += has(text_of("/proc/" + pid + "/stat"), ") Z ") ? 1 : 0;
    return count;
}

/// workers_file() with workers that restart after a crash.
Json returning_workers(int workers)
{
    auto content = workers_file(workers);
    content["drones"]["worker"]["restart"] = "on-failure";
    return content;
}

/// A supervising `up` of a swarm with this many workers, all running and connected.
class Staying {
public:
    Staying(const Swarm& swarm, const File& file, std::size_t workers)
        : swarm_(swarm), workers_(workers), up_(swarm.hivectl_running({"up", file, "--stay"}, "up"))
    {
        REQUIRE(eventually([&] { return all_run(); }));
    }
    /// Ctrl-C ends it, without any errors.
    void end()
    {
        up_.signal(SIGINT);
        CHECK(up_.wait(patient(10'000ms)) == 0);
    }
    [[nodiscard]] bool all_run() const
    {
        return running(swarm_).size() == workers_ + 2 && edges(swarm_) == static_cast<std::int64_t>(2 * workers_);
    }
    [[nodiscard]] std::string said() const { return swarm_.log("up"); }
    [[nodiscard]] pid_t pid() const { return up_.pid(); }

private:
    const Swarm& swarm_;
    std::size_t workers_;
    Process up_;
};

}  // namespace

TEST_CASE("up --stay: what crashes is restarted with its wires, with growing pauses, and what was stopped is not")
{
    const Swarm swarm;
    const File file(swarm, returning_workers(3));
    Staying up(swarm, file, 3);
    const auto before = running(swarm);
    auto application = swarm.application();  // faster than hivectl: all crashes must be within 60 s
    auto pid = before.at("worker-1");
    const auto runs_again = [&] {
        const auto answer = application.status(std::vector<std::string>{"worker-1"}).at(0);
        const auto* now = value_of(answer.status);
        const bool again = now && now->pid != pid && now->inputs.size() == 1 && now->inputs[0].connected
                           && connected_edges(now->outputs.at(0)) == 1;
        pid = again ? now->pid : pid;
        return again;
    };
    for (int fall = 0; fall < 5; ++fall) {
        ::kill(static_cast<pid_t>(pid), SIGKILL);
        REQUIRE_MESSAGE(eventually(runs_again, 10'000ms), "after ", fall, " falls: ", up.said());
    }
    CHECK(eventually([&] { return edges(swarm) == 6; }));
    ::kill(static_cast<pid_t>(pid), SIGKILL);
    const auto failed_row = [&] {
        for (const auto& row : Json::parse(swarm.hivectl_done({"ps", "--json", "--timeout", "10"})))
            if (row.at("state") == "failed")
                return row;
        return Json();
    };
    Json row;
    REQUIRE_MESSAGE(eventually([&] { return !(row = failed_row()).is_null(); }, 10'000ms), up.said());
    CHECK(row.at("name") == "worker-1");
    CHECK_MESSAGE(has(row.at("note"), "crashed 6 times in a row"), row.dump());
    CHECK(row.at("log") != "");
    CHECK_MESSAGE(eventually(runs_again, 20'000ms), up.said());
    CHECK(failed_row().is_null());

    swarm.hivectl_done({"stop", "worker-2"});
    ::kill(static_cast<pid_t>(before.at("sink")), SIGKILL);  // its file does not request a restart
    std::this_thread::sleep_for(500ms);
    CHECK(running(swarm).contains("worker-1"));
    CHECK(!running(swarm).contains("worker-2"));
    CHECK(!running(swarm).contains("sink"));
    CHECK(eventually([&] { return zombies_of(up.pid()) == 0; }));
    up.end();
    CHECK(swarm.application().drones().size() == 3);
    CHECK(steps(swarm, file).size() > 0);
    CHECK(has_processes(swarm, 5));
}

TEST_CASE("up --stay: a start that hangs holds up no other drone, and a drone that hangs is killed and restarted")
{
    const Swarm swarm;
    const File file(swarm, returning_workers(3));
    Staying up(swarm, file, 3);
    const auto before = running(swarm);
    swarm.hivectl_done({"set", "worker-1", "start_ms=50000"});
    const hive::event::Home home(swarm.home());
    const auto runs_again = [&](const std::string& worker) {
        const auto pids = running(swarm);
        return pids.contains(worker) && pids.at(worker) > 0 && pids.at(worker) != before.at(worker);
    };
    ::kill(static_cast<pid_t>(before.at("worker-1")), SIGKILL);
    REQUIRE(eventually([&] { return home.alive("worker-1") && home.holder("worker-1") != before.at("worker-1"); }));
    ::kill(static_cast<pid_t>(before.at("worker-2")), SIGKILL);
    CHECK_MESSAGE(eventually([&] { return runs_again("worker-2"); }, 5'000ms), up.said());
    ::kill(static_cast<pid_t>(before.at("worker-3")), SIGSTOP);
    CHECK_MESSAGE(eventually([&] { return has(up.said(), "worker-3 crashed and was restarted"); }, 30'000ms),
                  up.said());
    CHECK(has(up.said(), "worker-3 has not answered for 10 s and is killed"));
    swarm.hivectl_done({"down"}, 30'000ms);
    CHECK_MESSAGE(has_processes(swarm, 0), up.said());
    up.end();
}

TEST_CASE("up --stay: a drone that does not answer keeps no other one from coming back, which is said")
{
    const Swarm swarm;
    const File file(swarm, returning_workers(2));
    Staying up(swarm, file, 2);
    const auto before = running(swarm);
    const auto sink = static_cast<pid_t>(before.at("sink"));
    ::kill(sink, SIGSTOP);
    ::kill(static_cast<pid_t>(before.at("worker-1")), SIGKILL);
    CHECK(eventually([&] { return has(up.said(), "worker-1 crashed and was restarted"); }, 10'000ms));
    CHECK(eventually([&] { return has(up.said(), "sink does not answer"); }, 10'000ms));
    ::kill(sink, SIGCONT);
    CHECK_MESSAGE(eventually([&] { return edges(swarm) == 4; }, 10'000ms), up.said());
    CHECK(running(swarm).at("worker-1") != before.at("worker-1"));
    CHECK(eventually([&] { return zombies_of(up.pid()) == 0; }));
    up.end();
}

TEST_CASE("up --stay: whatever falls while down is at work, nothing comes back until the swarm is brought up again")
{
    const auto seed = seed_of_test();
    INFO("HIVE_TEST_SEED=" << seed);
    std::mt19937_64 random(seed);
    const Swarm swarm;
    auto content = returning_workers(3);
    content["drones"]["sink"]["restart"] = "always";
    const File file(swarm, content);
    Staying up(swarm, file, 3);
    std::vector<std::string> victims;  // each crashes less often than the limit within 60 s
    for (int i = 0; i < 4; ++i)
        victims.insert(victims.end(), {"worker-1", "worker-2", "worker-3", "sink"});
    std::ranges::shuffle(victims, random);
    for (std::size_t round = 0; round < victims.size() / 2; ++round) {
        CAPTURE(round);
        const auto pids = running(swarm);
        for (const auto& victim : {victims[2 * round], victims[2 * round + 1]}) {
            REQUIRE(pids.at(victim) > 0);
            ::kill(static_cast<pid_t>(pids.at(victim)), SIGKILL);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(random() % 150));  // it checks every 100 ms
        swarm.hivectl_done({"down"}, 30'000ms);
        CHECK_MESSAGE(has_processes(swarm, 0), up.said());
        std::this_thread::sleep_for(300ms);
        REQUIRE_MESSAGE(count_processes(swarm) == 0, up.said());
        CHECK(swarm.application().remembered().empty());
        steps(swarm, file);
        REQUIRE_MESSAGE(eventually([&] { return up.all_run(); }), up.said());
    }
    const auto sink = running(swarm).at("sink");
    ::kill(static_cast<pid_t>(sink), SIGKILL);
    const auto runs_again = [&] {
        const auto pids = running(swarm);
        return pids.contains("sink") && pids.at("sink") != sink;
    };
    CHECK_MESSAGE(eventually(runs_again, 10'000ms), up.said());
    up.end();
}

TEST_CASE("up --stay: down kills a drone that hangs, and none comes back")
{
    const Swarm swarm;
    auto content = returning_workers(2);
    for (auto& drone : content["drones"])
        drone["restart"] = "always";
    const File file(swarm, content);
    Staying up(swarm, file, 2);
    ::kill(static_cast<pid_t>(running(swarm).at("sink")), SIGSTOP);
    const auto down = swarm.hivectl({"down", "--timeout", "1"}, 30'000ms);
    CHECK_MESSAGE(down.exit_code == 0, down.err);
    CHECK_MESSAGE(eventually([&] { return has(up.said(), "source was taken down"); }, 20'000ms), up.said());
    CHECK_MESSAGE(has_processes(swarm, 0), up.said());
    std::this_thread::sleep_for(500ms);
    CHECK_MESSAGE(count_processes(swarm) == 0, up.said());
    CHECK(has(swarm.hivectl({"down"}).err, "no swarm was brought up"));
    up.end();
}

TEST_CASE("up --stay: down does not wait for a drone that is being started again, and it does not come up afterwards")
{
    const Swarm swarm;
    const File file(swarm, returning_workers(2));
    Staying up(swarm, file, 2);
    const auto start = patient(5000ms);
    swarm.hivectl_done({"set", "worker-1", "start_ms=" + std::to_string(start.count())});
    const auto before = running(swarm).at("worker-1");
    ::kill(static_cast<pid_t>(before), SIGKILL);
    const hive::event::Home home(swarm.home());
    REQUIRE(eventually([&] { return home.alive("worker-1") && home.holder("worker-1") != before; }));
    const auto down = swarm.hivectl({"down"});
    CHECK_MESSAGE(down.exit_code == 0, down.err);
    CHECK(down.took < start - 500ms);
    CHECK_MESSAGE(has_processes(swarm, 0), up.said());
    CHECK_MESSAGE(has(up.said(), "worker-1: not started now"), up.said());
    swarm.hivectl_done({"up", file, "--timeout", "60"}, 70'000ms);
    CHECK(running(swarm).size() == 4);
    up.end();
}

TEST_CASE("up --stay: a drone is restarted as the plan says that another up brought up last")
{
    const Swarm swarm;
    auto content = returning_workers(2);
    const File file(swarm, content);
    Staying up(swarm, file, 2);
    content["drones"]["worker"]["log_level"] = "debug";
    content["drones"]["sink"]["restart"] = "on-failure";
    content["drones"]["late"] = {{"kind", "sleeper"}, {"restart", "on-failure"}};
    content["connections"].push_back({{"from", "source"}, {"to", "late"}});
    file.write(content);
    steps(swarm, file);
    const auto before = running(swarm);
    auto application = swarm.application();
    const auto runs_again = [&](const std::string& drone) {
        return eventually(
            [&] {
                const auto answer = application.status(std::vector{drone}).at(0);
                const auto* now = value_of(answer.status);
                return now && now->pid != before.at(drone) && !now->inputs.empty() && now->inputs[0].connected;
            },
            10'000ms);
    };
    for (const std::string drone : {"worker-1", "sink", "late"}) {
        ::kill(static_cast<pid_t>(before.at(drone)), SIGKILL);
        CHECK_MESSAGE(runs_again(drone), drone, ": ", up.said());
        CHECK(eventually([&] { return has(up.said(), drone + " crashed and was restarted"); }));
    }
    CHECK(application.status("worker-1").order->log_level == "debug");
    CHECK(swarm.hivectl_done({"up", file}, 60'000ms) == "");
    content["drones"].erase("late");
    content["connections"].erase(2);
    content["drones"]["sink"].erase("restart");
    file.write(content);
    steps(swarm, file);
    ::kill(static_cast<pid_t>(running(swarm).at("sink")), SIGKILL);
    ::kill(static_cast<pid_t>(running(swarm).at("worker-1")), SIGKILL);
    CHECK_MESSAGE(eventually([&] { return running(swarm).contains("worker-1"); }, 10'000ms), up.said());
    std::this_thread::sleep_for(500ms);  // a restarted drone would be up by then
    CHECK(!running(swarm).contains("late"));
    CHECK(!running(swarm).contains("sink"));
    up.end();
}

TEST_CASE("up --stay: a drone whose key was removed comes back with the key, and one whose key was rotated at once")
{
    const Swarm swarm;
    const File file(swarm,
                    {{"swarm", "open"},
                     {"drones",
                      {{"source", {{"kind", "ticker"}, {"listen", "tcp://127.0.0.1"}, {"restart", "on-failure"}}},
                       {"worker", {{"kind", "sleeper"}, {"restart", "on-failure"}}}}},
                     {"connections", {{{"from", "source"}, {"to", "worker"}}}}});
    swarm.hivectl_done({"key", "new"});
    auto command = swarm.hivectl_running({"up", file, "--stay"}, "up");
    auto application = swarm.application();
    std::int64_t pid = 0;
    const auto runs_again = [&] {
        const auto answers = application.status(std::vector<std::string>{"source", "worker"});
        const auto *source = value_of(answers[0].status), *worker = value_of(answers[1].status);
        const bool again =
            source && worker && source->pid != pid && !worker->inputs.empty() && worker->inputs[0].connected;
        pid = again ? source->pid : pid;
        return again;
    };
    REQUIRE(eventually(runs_again));
    const auto key = swarm.home() / "config" / "hive" / "swarm.key";
    std::filesystem::rename(key, key.string() + ".away");
    ::kill(static_cast<pid_t>(pid), SIGKILL);
    CHECK_MESSAGE(eventually([&] { return has(swarm.log("up"), "there is no swarm key"); }, 10'000ms), swarm.log("up"));
    CHECK(value_of(application.status(std::vector<std::string>{"worker"}).at(0).status));
    std::filesystem::rename(key.string() + ".away", key);
    CHECK_MESSAGE(eventually(runs_again, 20'000ms), swarm.log("up"));
    swarm.hivectl_done({"key", "rotate", "--keep", "0"});
    ::kill(static_cast<pid_t>(pid), SIGKILL);
    CHECK_MESSAGE(eventually(runs_again, 20'000ms), swarm.log("up"));
    command.signal(SIGINT);
    CHECK(command.wait(patient(10'000ms)) == 0);
}

TEST_CASE("up --stay: a second up does not wait for a drone that is being restarted, and each drone runs once")
{
    const Swarm swarm;
    const File file(swarm, returning_workers(2));
    Staying up(swarm, file, 2);
    const auto before = running(swarm).at("worker-1");
    const hive::event::Home home(swarm.home());
    swarm.hivectl_done({"set", "worker-1", "start_ms=1500"});
    for (int round = 0; round < 3; ++round) {
        const auto pid = home.holder("worker-1");
        ::kill(static_cast<pid_t>(pid), SIGKILL);
        REQUIRE(eventually([&] { return home.alive("worker-1") && home.holder("worker-1") != pid; }, 10'000ms));
        const auto second = swarm.hivectl({"up", file}, 60'000ms);
        CHECK_MESSAGE(second.exit_code == 0, second.err, up.said());
        CHECK_MESSAGE(eventually([&] { return up.all_run(); }), up.said());
        CHECK(has_processes(swarm, 4));
    }
    CHECK(has(up.said(), "worker-1: not started now"));
    CHECK(running(swarm).at("worker-1") != before);
    up.end();
}

TEST_CASE("up --stay: a replacement is no crash, and of a drone that is being restarted it is refused")
{
    const Swarm swarm;
    const File file(swarm, returning_workers(2));
    Staying up(swarm, file, 2);
    for (int round = 0; round < 5; ++round)
        swarm.hivectl_done({"replace", "worker-2"}, 40'000ms);
    CHECK_MESSAGE(!has(up.said(), "crashed"), up.said());
    const auto before = running(swarm).at("worker-1");
    swarm.hivectl_done({"set", "worker-1", "start_ms=3000"});
    ::kill(static_cast<pid_t>(before), SIGKILL);
    const hive::event::Home home(swarm.home());
    REQUIRE(eventually([&] { return home.alive("worker-1") && home.holder("worker-1") != before; }));
    const auto early = swarm.hivectl({"replace", "worker-1", "--timeout", "2"}, 40'000ms);
    CHECK_MESSAGE(early.exit_code != 0, early.out);
    swarm.hivectl_done({"replace", "worker-2"}, 40'000ms);
    CHECK_MESSAGE(eventually([&] { return up.all_run(); }, 20'000ms), up.said());
    swarm.hivectl_done({"replace", "worker-1", "start_ms=0"}, 40'000ms);
    CHECK_MESSAGE(eventually([&] { return up.all_run(); }, 20'000ms), up.said());
    CHECK(has_processes(swarm, 4));
    up.end();
}
