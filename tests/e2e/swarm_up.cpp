// Whole swarms from one file: a second up changes nothing, a change is one step, a failure leaves nothing behind, and
// after a kill the next up completes the work.
#include "falling_drone.hpp"
#include "programs_for_tests.hpp"
#include "worker_swarm.hpp"

#include <doctest/doctest.h>
#include <free_port.hpp>
#include <hive/event/home.hpp>
#include <mute_server.hpp>

#include <algorithm>
#include <csignal>
#include <random>
#include <set>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

TEST_CASE("up: starts, sets and connects what the file says, and a second up finds nothing to do")
{
    const Swarm swarm;
    const File file(swarm, workers_file(3));
    CHECK(lines_of(swarm.hivectl_done({"up", file, "--dry-run"})) == 11);
    CHECK(has_processes(swarm, 0));
    CHECK(steps(swarm, file).size() == 11);
    const auto pids = running(swarm);
    CHECK(pids.size() == 5);
    CHECK(edges(swarm) == 6);
    CHECK(swarm.hivectl_done({"get", "source", "fps"}) == "50.0\n");
    CHECK(steps(swarm, file).empty());
    CHECK(running(swarm) == pids);
    CHECK(lines_of(swarm.hivectl_done({"results", "worker-*", "-n", "10"})) == 10);
    CHECK(lines_of(swarm.hivectl_done({"down"})) == 5);
    CHECK(has_processes(swarm, 0));
    CHECK(swarm.hivectl_done({"down", file}).empty());
}

TEST_CASE("up: a drone receives from more senders than it accepts requests at once")
{
    const Swarm swarm;
    const File file(swarm, workers_file(40));
    steps(swarm, file);
    CHECK(edges(swarm) == 80);
}

TEST_CASE("up: of a changed file only the change is made, and nothing is started again")
{
    const Swarm swarm;
    auto content = workers_file(3);
    const File file(swarm, content);
    steps(swarm, file);
    const auto pids = running(swarm);

    content["drones"]["worker"]["set"]["work_ms"] = 2;
    content["drones"]["source"]["set"]["fps"] = "40";
    file.write(content);
    CHECK(swarm.hivectl_done({"up", file})
          == "set source fps=40\nset worker-1 work_ms=2\nset worker-2 work_ms=2\nset worker-3 work_ms=2\n");
    CHECK(steps(swarm, file).empty());
    CHECK(running(swarm) == pids);

    content["connections"][0]["window"] = 4;
    file.write(content);
    CHECK(steps(swarm, file).size() == 3);
    content["connections"].erase(1);
    file.write(content);
    CHECK(swarm.hivectl_done({"up", file})
          == "disconnect worker-1.result -> sink.image\ndisconnect worker-2.result -> sink.image\n"
             "disconnect worker-3.result -> sink.image\n");
    content["drones"]["worker"]["count"] = 1;
    content["drones"].erase("sink");
    file.write(content);
    const auto fewer = steps(swarm, file);
    CHECK(std::ranges::count_if(fewer, [](const auto& step) { return step.starts_with("stop "); }) == 3);
    CHECK(running(swarm).size() == 2);
    CHECK(steps(swarm, file).empty());
}

TEST_CASE("up: a camera without frames is reported by name within 2 s, one that has frames delays nothing")
{
    const Swarm swarm;
    const auto source = "rtsp://127.0.0.1:" + std::to_string(free_port()) + "/video";
    const auto camera = [](const std::string& from) { return Json{{"kind", "camera"}, {"set", {{"source", from}}}}; };
    Json content{{"swarm", "cams"}, {"drones", {{"away", camera(source)}, {"here", {{"kind", "camera"}}}}}};
    const File file(swarm, content);
    const auto begin = Clock::now();
    const auto up = swarm.hivectl({"up", file});
    CHECK(Clock::now() - begin < patient(4s));
    CHECK(up.exit_code == 0);
    CHECK(up.out == "start away\nstart here\n");
    CHECK_MESSAGE(has(up.err, "hivectl up: away reports: "), up.err);
    CHECK_MESSAGE(has(up.err, source + ": Connection refused; see: hivectl explain away\n"), up.err);
    content["drones"]["away"]["set"]["source"] = "scene";
    file.write(content);
    CHECK(swarm.hivectl({"up", file}).out == "set away source=scene\n");
    auto application = swarm.application();
    CHECK(eventually([&] { return application.status("away").condition.empty(); }));
}

TEST_CASE("up: what was connected or set by hand beside the file is left alone, and what fell is started again")
{
    const Swarm swarm;
    const File file(swarm, workers_file(2));
    steps(swarm, file);
    const auto extra = swarm.drone("sleeper", "extra");
    swarm.hivectl_done({"connect", "source", "extra"});
    swarm.hivectl_done({"set", "worker-1", "throw_at=1000000"});
    CHECK(steps(swarm, file).empty());

    const auto before = running(swarm);
    ::kill(static_cast<pid_t>(before.at("worker-2")), SIGKILL);
    REQUIRE(eventually([&] { return running(swarm).count("worker-2") == 0; }));
    CHECK(steps(swarm, file).front() == "start worker-2");
    CHECK(steps(swarm, file).empty());
    auto after = running(swarm);
    CHECK(after.at("worker-1") == before.at("worker-1"));
    CHECK(swarm.hivectl_done({"down", file}) != "");
    CHECK(running(swarm).size() == 1);
}

TEST_CASE(
    "up: a value that a drone rounds is set once, also by its command line, and is in the export as it was asked for")
{
    const Swarm swarm;
    auto content = workers_file(1);
    content["drones"]["worker"]["set"] = {{"work_ms", 17}, {"step_ms", 10}};
    const File file(swarm, content);
    steps(swarm, file);
    CHECK(swarm.hivectl_done({"get", "worker-1", "work_ms"}) == "10\n");
    CHECK(steps(swarm, file).empty());

    content["drones"]["worker"]["set"]["work_ms"] = 23;
    file.write(content);
    CHECK(swarm.hivectl_done({"up", file}) == "set worker-1 work_ms=23\n");
    CHECK(swarm.hivectl_done({"get", "worker-1", "work_ms"}) == "20\n");
    CHECK(steps(swarm, file).empty());
    CHECK(Json::parse(swarm.hivectl_done({"export"}))["drones"]["worker-1"]["set"]["work_ms"] == 23);

    ::kill(static_cast<pid_t>(running(swarm).at("worker-1")), SIGKILL);
    REQUIRE(eventually([&] { return running(swarm).count("worker-1") == 0; }));
    const auto again = swarm.drone("sleeper", "worker-1");  // with its saved state, and nothing from the file
    CHECK(swarm.hivectl_done({"get", "worker-1", "work_ms"}) == "20\n");
    CHECK(steps(swarm, file).empty());
}

TEST_CASE("up: when the last drone does not start, nothing is left of the others, and the log says why")
{
    const Swarm swarm;
    auto content = workers_file(3);
    const MuteServer other;
    const auto taken = "tcp://127.0.0.1:" + other.port();
    content["drones"]["zlast"] = {{"kind", "ticker"}, {"listen", taken}, {"insecure", true}};
    const File file(swarm, content);
    const auto refused = swarm.hivectl({"up", file}, 60'000ms);
    CHECK(refused.exit_code == 5);
    CHECK(refused.out.empty());
    CHECK_MESSAGE(has(refused.err, "zlast"), refused.err);
    CHECK_MESSAGE(has(refused.err, taken), refused.err);
    CHECK(has_processes(swarm, 0));
    CHECK(swarm.hivectl_done({"down"}).empty());
}

TEST_CASE("up: a drone that falls when it has its name, before it is ready, is told at once, and nothing is left")
{
    const Swarm swarm;
    write_falling_drone(swarm.home() / "programs");
    auto content = workers_file(2);
    content["drones"]["brief"] = {{"kind", "falls"}};
    const File file(swarm, content);
    const auto refused = swarm.run({"/usr/bin/env", "HIVE_DRONE_PATH=" + (swarm.home() / "programs").string(),
                                    swarm.program("hivectl").string(), "up", file, "--timeout", "50"},
                                   60'000ms);
    CHECK_MESSAGE(refused.exit_code == 5, refused.err);
    CHECK_MESSAGE(has(refused.err, "brief ended with exit code 7"), refused.err);
    CHECK_MESSAGE(has(refused.err, "no film left"), refused.err);
    CHECK(has_processes(swarm, 0));
}

TEST_CASE("up: of many drones that fail alike the first 20 are named and the others counted, with --json all are named")
{
    const Programs programs({"hive-hangs"}, "#!/bin/sh\n"
                                            "[ \"$1\" = --describe ] || exec sleep 60\n"
                                            "echo '{\"kind\": \"hangs\", \"version\": \"1\", \"summary\": \"Hangs.\","
                                            " \"inputs\": [], \"outputs\": [], \"parameters\": []}'\n");
    const Swarm swarm;
    const File file(swarm, {{"swarm", "work"}, {"drones", {{"slow", {{"kind", "hangs"}, {"count", 23}}}}}});
    const auto refused = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"up", file, "--timeout", "3"});
        const auto finished = swarm.hivectl(words, 60'000ms);
        CHECK_MESSAGE(finished.exit_code == 5, finished.err);
        int named = 0;
        for (int i = 1; i <= 23; ++i)
            named += has(finished.err, "slow-" + std::to_string(i) + " was not ready in time") ? 1 : 0;
        return std::pair(named, has(finished.err, "and 3 more of the same kind; see all: --json\n"));
    };
    CHECK(refused({}) == std::pair(20, true));
    CHECK(refused({"--json"}) == std::pair(23, false));
    CHECK(has_processes(swarm, 0));
}

TEST_CASE("up: when a running drone refuses a value, the values and connections made before are taken back")
{
    const Swarm swarm;
    auto content = workers_file(2);
    content["drones"]["worker"]["set"]["most_ms"] = 100;
    const File file(swarm, content);
    steps(swarm, file);
    const auto pids = running(swarm);

    content["drones"]["source"]["set"]["fps"] = 10;
    content["drones"]["more"] = {{"kind", "sleeper"}};
    content["drones"]["worker"]["set"]["work_ms"] = 200;
    file.write(content);
    const auto refused = swarm.hivectl({"up", file}, 60'000ms);
    CHECK(refused.exit_code == 5);
    CHECK_MESSAGE(has(refused.err, "work_ms 200 is more than 100"), refused.err);
    CHECK(swarm.hivectl_done({"get", "source", "fps"}) == "50.0\n");
    CHECK(swarm.hivectl_done({"get", "worker-1", "work_ms"}) == "1\n");
    CHECK(running(swarm) == pids);
    CHECK(has_processes(swarm, 5 - 1));
}

TEST_CASE("up: a name that another drone has is refused before anything is begun")
{
    const Swarm swarm;
    const auto other = swarm.drone("ticker", "sink");
    const File file(swarm, workers_file(1));
    const auto refused = swarm.hivectl({"up", file});
    CHECK(refused.exit_code != 0);
    CHECK_MESSAGE(has(refused.err, "sink runs already and is a ticker, not a sleeper"), refused.err);
    CHECK(has_processes(swarm, 1));
}

TEST_CASE("up: while somebody else changes the swarm it says that it waits, ends by Ctrl-C, and goes on when it may")
{
    const Swarm swarm;
    const File file(swarm, workers_file(1));
    const hive::event::Home home(swarm.home());
    auto other = std::make_unique<hive::event::NameClaim>(home, "work.swarm");
    const auto refused = swarm.hivectl({"up", file, "--timeout", "2"});
    CHECK(refused.exit_code != 0);
    const std::string waits = "hivectl up: another process is changing the swarm work now; waiting until that is done";
    CHECK_MESSAGE(has(refused.err, waits), refused.err);
    CHECK_MESSAGE(has(refused.err, "try again when that is done"), refused.err);
    auto interrupted = swarm.hivectl_running({"up", file}, "interrupted");
    auto patient_one = swarm.hivectl_running({"up", file}, "patient");
    for (const std::string name : {"interrupted", "patient"})
        REQUIRE(eventually([&] { return has(swarm.log(name), waits); }));
    interrupted.signal(SIGINT);
    CHECK(interrupted.wait(patient(5000ms)) == 130);
    CHECK(has_processes(swarm, 0));
    other.reset();
    CHECK(patient_one.wait(patient(20'000ms)) == 0);
    CHECK(has_processes(swarm, 3));
}

TEST_CASE("up: killed at any moment, the next one completes it, no drone twice and none left over")
{
    const auto seed = seed_of_test();
    INFO("HIVE_TEST_SEED=" << seed);
    std::mt19937_64 random(seed);
    const Swarm swarm;
    const File file(swarm, workers_file(4));
    const char* const more = std::getenv("HIVE_TEST_ROUNDS");
    const int rounds = more ? std::stoi(more) : sanitized() ? 5 : 20;
    const auto took = std::chrono::microseconds(swarm.hivectl({"up", file}, 60'000ms).took).count();
    swarm.hivectl_done({"down"});
    for (int round = 0; round < rounds; ++round) {
        auto up = swarm.hivectl_running({"up", file}, "up");
        std::this_thread::sleep_for(std::chrono::microseconds(random() % static_cast<std::uint64_t>(took)));
        up.kill();
        const auto again = swarm.hivectl({"up", file}, 60'000ms);
        REQUIRE_MESSAGE(again.exit_code == 0, again.err);
        CHECK(steps(swarm, file).empty());
        CHECK(running(swarm).size() == 6);
        CHECK(edges(swarm) == 8);
        CHECK(has_processes(swarm, 6));
        if (random() % 2 == 0) {
            swarm.hivectl_done({"down"});
            CHECK(has_processes(swarm, 0));
        }
    }
}

TEST_CASE("up: Ctrl-C undoes what was begun")
{
    // A drone that is never ready, so the signal arrives before the end.
    const Programs programs({"hive-slow"}, R"(#!/bin/sh
case "$*" in *--describe*) echo '{"kind": "slow", "inputs": [], "outputs": [], "parameters": []}'; exit ;; esac
exec sleep 60
)");
    const Swarm swarm;
    auto content = workers_file(60);
    content["drones"]["slow"] = {{"kind", "slow"}};
    const File file(swarm, content);
    auto up = swarm.hivectl_running({"up", file}, "up");
    REQUIRE(eventually([&] { return std::filesystem::exists(swarm.home() / "worker-5.sock"); }));
    up.signal(SIGINT);
    CHECK(up.wait(patient(20'000ms)) == 130);
    CHECK(has_processes(swarm, 0));
    CHECK(swarm.hivectl_done({"down"}).empty());
}

/// Of a whole file, and of one whose drones are up and only have to be connected.
TEST_CASE("up: Ctrl-C at any moment leaves all as it was, or comes too late")
{
    const auto seed = seed_of_test();
    INFO("HIVE_TEST_SEED=" << seed);
    std::mt19937_64 random(seed);
    const Swarm swarm;
    auto unconnected = workers_file(6);
    unconnected.erase("connections");
    const File file(swarm, workers_file(6));
    const char* const more = std::getenv("HIVE_TEST_ROUNDS");
    const int rounds = more ? std::stoi(more) : sanitized() ? 4 : 16;
    for (int round = 0; round < rounds; ++round) {
        INFO("round " << round);
        const bool drones_are_up = round % 2 == 0;
        const auto begin = [&] {
            swarm.hivectl_done({"down"});
            file.write(unconnected);
            if (drones_are_up)
                swarm.hivectl_done({"up", file});
            file.write(workers_file(6));
        };
        begin();
        const auto took = std::chrono::microseconds(swarm.hivectl({"up", file}, 60'000ms).took).count();
        begin();
        auto up = swarm.hivectl_running({"up", file}, "up");
        std::this_thread::sleep_for(std::chrono::microseconds(random() % static_cast<std::uint64_t>(took)));
        up.signal(SIGINT);
        const auto code = up.wait(patient(20'000ms));
        INFO(swarm.log("up"));
        if (code == 0) {
            CHECK(steps(swarm, file).empty());
            continue;
        }
        CHECK(code == 130);
        CHECK(has_processes(swarm, drones_are_up ? 8 : 0));
        CHECK((drones_are_up ? edges(swarm) : 0) == 0);
    }
}

TEST_CASE("up: two at once make one swarm")
{
    const Swarm swarm;
    const File file(swarm, workers_file(4));
    auto one = swarm.hivectl_running({"up", file}, "one"), two = swarm.hivectl_running({"up", file}, "two");
    const auto first = one.wait(patient(30'000ms)), second = two.wait(patient(30'000ms));
    CHECK((first == 0 || second == 0));
    CHECK(steps(swarm, file).empty());
    CHECK(has_processes(swarm, 6));
}

TEST_CASE("down: Ctrl-C while it waits for its turn leaves all swarms as they are")
{
    const Swarm swarm;
    const File file(swarm, workers_file(1));
    swarm.hivectl_done({"up", file});
    file.write({{"swarm", "yard"}, {"drones", {{"clock", {{"kind", "ticker"}}}}}});  // it is taken down after `work`
    swarm.hivectl_done({"up", file});
    const hive::event::Home home(swarm.home());
    const hive::event::NameClaim other(home, "work.swarm");
    auto down = swarm.hivectl_running({"down"}, "down");
    REQUIRE(eventually([&] { return has(swarm.log("down"), "another process is changing the swarm work now"); }));
    down.signal(SIGINT);
    CHECK(down.wait(patient(5000ms)) == 130);
    CHECK(has(swarm.log("down"), "hivectl down: yard was left as it is"));
    CHECK(running(swarm).size() == 4);
}

TEST_CASE("down: a drone that hangs is killed, also where the file names engines")
{
    const Swarm swarm;
    auto content = workers_file(1);
    content["engines"] = {{"*", {{"local", Json::object()}}}};
    const File file(swarm, content);
    swarm.hivectl_done({"up", file});
    const auto sink = static_cast<pid_t>(running(swarm).at("sink"));
    ::kill(sink, SIGSTOP);
    const auto down = swarm.hivectl({"down", "--timeout", "1"}, 30'000ms);
    CHECK_MESSAGE(down.exit_code == 0, down.err);
    CHECK(has_processes(swarm, 0));
    CHECK(has(swarm.hivectl({"down"}).err, "no swarm was brought up"));
}

TEST_CASE("down: nothing lossless that was on its way is lost")
{
    const Swarm swarm;
    auto content = workers_file(2);
    content["drones"]["source"]["set"] = {{"pace", "demand"}, {"bytes", 100}};
    content["drones"]["worker"]["set"]["work_ms"] = 20;
    const File file(swarm, content);
    steps(swarm, file);
    auto application = swarm.application();
    const auto results = application.collect({application.endpoint("sink")}, {});
    std::int64_t produced = 0, taken = 0;
    std::set<std::int64_t> indexes;
    const auto look = [&] {
        for (const auto& answer : application.status(std::vector<std::string>{"source"}))
            if (const auto* status = value_of(answer.status))
                produced = status->outputs.at(0).produced;
        for (; const auto result = results->next(1ms); ++taken)
            indexes.insert(result->header.at("index").get<std::int64_t>());
    };
    REQUIRE(eventually([&] { return look(), taken > 20; }));
    auto down = swarm.hivectl_running({"down"}, "down");
    std::optional<int> code;
    REQUIRE(eventually([&] { return look(), (code = down.wait(0ms)).has_value(); }, 20'000ms));
    CHECK(code == 0);
    CHECK(eventually([&] { return look(), taken >= produced; }));  // it may have made more since it last answered
    CHECK(std::ssize(indexes) == taken);
    CHECK(*indexes.rbegin() == taken);  // none is missing in between
    CHECK(results->counts().missing == 0);
    CHECK(has_processes(swarm, 0));
}

TEST_CASE("export: up of it changes nothing here, and elsewhere makes a swarm with the same export")
{
    const Swarm here, there;
    auto content = workers_file(2);
    content["drones"]["worker"]["restart"] = "on-failure";
    const File file(here, content);
    steps(here, file);
    here.hivectl_done({"set", "worker-2", "work_ms=3"});
    here.hivectl_done({"halt", "sink"});
    const auto text = here.hivectl_done({"export"});
    const File same(here, Json::parse(text));
    CHECK(steps(here, same).empty());
    const File copy(there, Json::parse(text));
    CHECK(steps(there, copy).size() == 4 + 4);
    CHECK(there.hivectl_done({"export"}) == text);
    const auto typo = there.hivectl({"export", "wroker-1"});
    CHECK(typo.exit_code == 3);
    CHECK(typo.out.empty());
}
