// An `up` that stays: what falls comes back with its wires, and nothing else holds that up.
#include "status_sums.hpp"
#include "worker_swarm.hpp"

#include <doctest/doctest.h>

#include <csignal>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// Children that have ended and that nobody has looked for.
std::size_t zombies_of(pid_t parent)
{
    const auto number = std::to_string(parent), children = text_of("/proc/" + number + "/task/" + number + "/children");
    std::istringstream pids(children);
    std::size_t count = 0;
    for (std::string pid; pids >> pid;)
        count += has(text_of("/proc/" + pid + "/stat"), ") Z ") ? 1 : 0;
    return count;
}

}  // namespace

TEST_CASE(
    "up --stay: what falls is started again with its wires, what was stopped is not, and who falls too often is failed")
{
    const Swarm swarm;
    auto content = workers_file(3);
    content["drones"]["worker"]["restart"] = "on-failure";
    const File file(swarm, content);
    auto up = swarm.hivectl_running({"up", file, "--stay"}, "up");
    REQUIRE(eventually([&] { return running(swarm).size() == 5 && edges(swarm) == 6; }));
    const auto before = running(swarm);
    auto application = swarm.application();  // quicker than hivectl: all the falls must be within 60 s
    auto pid = before.at("worker-1");
    const auto runs_again = [&] {
        const auto answer = application.status(std::vector<std::string>{"worker-1"}).at(0);
        const auto& now = answer.status;
        const bool again = !answer.error && now.pid != pid && now.inputs.size() == 1 && now.inputs[0].connected
                           && connected_edges(now.outputs.at(0)) == 1;
        pid = again ? now.pid : pid;
        return again;
    };
    for (int fall = 0; fall < 5; ++fall) {
        ::kill(static_cast<pid_t>(pid), SIGKILL);
        REQUIRE_MESSAGE(eventually(runs_again, 10'000ms), "after ", fall, " falls: ", swarm.log("up"));
    }
    CHECK(eventually([&] { return edges(swarm) == 6; }));
    ::kill(static_cast<pid_t>(pid), SIGKILL);
    const auto failed_row = [&] {
        for (const auto& row : Json::parse(swarm.hivectl_done({"ps", "--json", "--timeout", "10"})))
            if (row.at("state") == "failed")
                return row;
        return Json();
    };
    REQUIRE(eventually([&] { return !failed_row().is_null(); }, 10'000ms));
    CHECK(failed_row().at("name") == "worker-1");
    CHECK_MESSAGE(has(failed_row().at("note"), "fell 6 times within 60 s"), failed_row().dump());
    CHECK(failed_row().at("log") != "");

    swarm.hivectl_done({"stop", "worker-2"});
    ::kill(static_cast<pid_t>(before.at("sink")), SIGKILL);  // its file does not say that it is to come back
    std::this_thread::sleep_for(500ms);
    CHECK(running(swarm).contains("worker-1"));  // the row of the failed one
    CHECK(!running(swarm).contains("worker-2"));
    CHECK(!running(swarm).contains("sink"));
    CHECK(eventually([&] { return zombies_of(up.pid()) == 0; }));
    up.signal(SIGINT);
    CHECK(up.wait(patient(10'000ms)) == 0);
    CHECK(swarm.application().drones().size() == 2);
    CHECK(steps(swarm, file).size() > 0);
    CHECK(has_processes(swarm, 5));
    swarm.hivectl_done({"stop", "worker-1"});  // it runs again, though nobody has looked since it was failed
    CHECK(has_processes(swarm, 4));
    CHECK(failed_row().is_null());
    CHECK(running(swarm).size() == 4);
}

TEST_CASE("up --stay: a drone that does not answer keeps no other one from coming back, which is said")
{
    const Swarm swarm;
    auto content = workers_file(2);
    content["drones"]["worker"]["restart"] = "on-failure";
    const File file(swarm, content);
    auto up = swarm.hivectl_running({"up", file, "--stay"}, "up");
    REQUIRE(eventually([&] { return running(swarm).size() == 4 && edges(swarm) == 4; }));
    const auto before = running(swarm);
    const auto sink = static_cast<pid_t>(before.at("sink"));
    ::kill(sink, SIGSTOP);
    ::kill(static_cast<pid_t>(before.at("worker-1")), SIGKILL);
    CHECK(eventually([&] { return has(swarm.log("up"), "worker-1 had fallen and runs again"); }, 10'000ms));
    CHECK(eventually([&] { return has(swarm.log("up"), "hivectl up: sink: "); }, 10'000ms));
    ::kill(sink, SIGCONT);
    CHECK_MESSAGE(eventually([&] { return edges(swarm) == 4; }, 10'000ms), swarm.log("up"));
    CHECK(running(swarm).at("worker-1") != before.at("worker-1"));
    CHECK(zombies_of(up.pid()) == 0);
    up.signal(SIGINT);
    CHECK(up.wait(patient(10'000ms)) == 0);
}
