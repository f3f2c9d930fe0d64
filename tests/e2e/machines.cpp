// The commands of README's "Several machines" between machines: network namespaces, each with its own sshd. Needs root,
// iproute2 and openssh-server; otherwise the tests are skipped.
#include "bad_link.hpp"
#include "lab.hpp"
#include "reader.hpp"
#include "rows.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <csignal>
#include <set>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

TEST_CASE("machines: README's commands for several machines work as they stand there")
{
    if (!possible(missing_for_lab()))
        return;
    const Lab lab({"cam1", "gpu1", "gpu2"});
    lab.shell_done("for machine in cam1 gpu1 gpu2; do ssh $machine mkdir -p .config/hive; done");  // as README says
    auto commands = indented_commands(std::filesystem::path(HIVE_SOURCE_DIR) / "README.md", "## Several machines");
    const std::string device = "source=/dev/video0";
    REQUIRE(has(commands, device));
    if (!std::filesystem::exists("/dev/video0"))
        commands.replace(commands.find(device), device.size(), "source=scene");
    const auto script = lab.directory() / "readme.sh";
    std::ofstream(script) << reader_script(lab.laptop(), commands, 15);
    const auto finished = lab.shell("exec bash " + script.string(), 120'000ms);
    REQUIRE_MESSAGE(finished.exit_code == 0, commands, finished.out, finished.err);
    std::istringstream lines(finished.out);
    std::int64_t last = 0;
    std::set<std::string> workers, placed;
    for (std::string line; std::getline(lines, line);) {
        for (const std::string machine : {"cam1", "gpu1", "gpu2"})
            if (has(line, " " + machine + " "))
                placed.insert(line.substr(0, line.find(' ')) + "@" + machine);  // a row of ps
        if (!line.starts_with("{\"") || !has(line, "\"seq\""))
            continue;
        const auto result = Json::parse(line);
        CHECK(result.at("seq").get<std::int64_t>() > last);
        last = result.at("seq").get<std::int64_t>();
        workers.insert(result.at("sender").get<std::string>());
    }
    const std::set<std::string> where{"camera@cam1", "face-1@gpu1", "face-2@gpu2"}, who{"face-1", "face-2"};
    CHECK_MESSAGE(placed == where, finished.out);
    CHECK_MESSAGE(workers == who, finished.out);
}

TEST_CASE("machines: a camera and two workers on three machines, wired and collected from a fourth")
{
    if (!possible(missing_for_lab()))
        return;
    const Lab lab({"cam1", "gpu1", "gpu2"});
    lab.hivectl_done("key new");
    const auto refused = lab.shell("hivectl start camera --on cam1 source=scene fps=20");
    CHECK(refused.exit_code == 5);
    CHECK_MESSAGE(has(refused.err, "there is no swarm key at "), refused.err);
    for (const std::string host : {"cam1", "gpu1", "gpu2"}) {
        lab.shell_done("ssh " + host + " mkdir -p .config/hive");
        lab.shell_done("scp ~/.config/hive/swarm.key " + host + ":.config/hive/");
    }
    lab.hivectl_done("start camera --on cam1 source=scene fps=20");
    lab.hivectl_done("start face --on gpu1 --as face-1");
    lab.hivectl_done("start face --on gpu2 --as face-2");
    lab.hivectl_done("connect camera face-1 face-2 --share");
    const auto ps = lab.hivectl_done("ps --json");
    CHECK(row_named(ps, "name", "camera").at("host") == "cam1");
    CHECK(row_named(ps, "name", "face-2").at("host") == "gpu2");
    std::istringstream results(lab.hivectl_done("results 'face-*' --ordered -n 6"));
    std::int64_t last = 0;
    for (std::string line; std::getline(results, line);) {
        const auto seq = Json::parse(line).at("seq").get<std::int64_t>();
        CHECK(seq > last);
        last = seq;
    }
    CHECK(last > 0);
    for (const auto& edge : Json::parse(lab.hivectl_done("edges --json"))) {
        if (edge.at("kind") != "member")
            continue;
        CHECK(edge.at("encoding") == "jpeg");
        CHECK(edge.at("from_host") == "cam1");
        CHECK(edge.at("to_host") == (edge.at("to") == "face-1.image" ? "gpu1" : "gpu2"));
        CHECK(edge.at("round_trip_us").get<std::int64_t>() > 0);
        // One clock for all namespaces, so the measured offset is the error.
        CHECK(std::abs(edge.at("clock_offset_us").get<std::int64_t>()) < 100'000);
    }
    CHECK(has(lab.hivectl_done("logs face-1"), "listening on tcp://"));
    CHECK(lab.hivectl_done("set camera source=scene") == "scene\n");  // over the network it is not permitted
    lab.hivectl_done("stop --all");
    CHECK(lab.hivectl_done("ps --json") == "[]\n");
}

TEST_CASE("machines: a drone that is killed is unreachable, and is where it was when its machine starts it again")
{
    if (!possible(missing_for_lab()))
        return;
    const Lab lab({"cam1", "gpu1"});
    lab.share_key();
    lab.hivectl_done("start ticker --on cam1 fps=100");
    lab.hivectl_done("start sleeper --on gpu1");
    lab.hivectl_done("connect ticker sleeper");
    const auto& cam1 = lab.machine(0);
    ::kill(row_named(lab.hivectl_done("ps --json --timeout 10"), "name", "ticker").at("pid").get<pid_t>(), SIGKILL);
    REQUIRE(eventually([&] { return cam1.swarm.application().drones().empty(); }));
    CHECK(row_named(lab.hivectl_done("ps --json"), "name", "ticker").at("state") == "unreachable");
    const auto again = cam1.swarm.run(cam1.net.inside({cam1.swarm.program("hivectl").string(), "start", "ticker"}));
    REQUIRE_MESSAGE(again.exit_code == 0, again.err);
    CHECK(lab.hivectl_done("get ticker fps") == "100.0\n");
    const auto received = [&] {
        return Json::parse(lab.hivectl_done("edges sleeper --json")).at(0).value("received", Json()).is_number();
    };
    CHECK(eventually(received, 10'000ms));
    CHECK(has(lab.hivectl_done("results sleeper -n 1"), "\"seq\""));
}

TEST_CASE("machines: a long way is measured, and a larger window lets more through, as connections advises")
{
    if (!possible(missing_for_lab()))
        return;
    const Lab lab({"cam1", "gpu1"});
    lab.share_key();
    lab.hivectl_done("start ticker --on cam1 fps=200");
    lab.hivectl_done("start sleeper --on gpu1");
    const BadLink far(lab.machine(0), lab.machine(1), {.delay = 50ms});
    const auto& gpu1 = lab.machine(1);
    auto application = gpu1.swarm.application();
    const auto input = [&] { return application.status("sleeper").inputs.at(0); };
    lab.hivectl_done("connect ticker sleeper");
    REQUIRE(eventually([&] { return input().round_trip_us > 0 && input().received > 5; }, 10'000ms));
    CHECK(input().round_trip_us >= 100'000);
    CHECK(input().options.window == 1);
    const auto edges = lab.shell("hivectl connections");
    CHECK_MESSAGE(has(edges.err, "hivectl connect ticker.tick sleeper.image --window "), edges.err);
    const auto rate = [&](int events) {
        const auto begin = Clock::now();  // before the query: later events are not counted
        const auto before = input().received;
        auto now = before;
        REQUIRE(eventually([&] { return (now = input().received) >= before + events; }, 10'000ms));
        return static_cast<double>(now - before) / std::chrono::duration<double>(Clock::now() - begin).count();
    };
    const auto narrow = rate(10);
    CHECK(narrow < 11);
    lab.hivectl_done("connect ticker sleeper --window 16");
    CHECK(rate(100) > 2 * narrow);  // for so long that a moment of nothing does not count
}

TEST_CASE("machines: nine receivers that are connected together over a long way take about as long as one")
{
    if (!possible(missing_for_lab()))
        return;
    const Lab lab({"cam1", "gpu1"});
    lab.share_key();
    lab.hivectl_done("start ticker --on cam1");
    lab.hivectl_done("start sleeper --as alone --on gpu1");
    for (int i = 1; i <= 9; ++i)
        lab.hivectl_done("start sleeper --as worker-" + std::to_string(i) + " --on gpu1");
    const BadLink far(lab.machine(0), lab.machine(1), {.delay = 100ms});
    const auto time_of = [&](const std::string& receivers, int connected) {
        const auto begin = Clock::now();
        CHECK(lines_of(lab.hivectl_done("connect ticker " + receivers)) == connected);
        return Clock::now() - begin;
    };
    const auto one = time_of("alone", 1), nine = time_of("'worker-?'", 9);
    CHECK(one > 200ms);
    CHECK(nine < 4 * one);
}
