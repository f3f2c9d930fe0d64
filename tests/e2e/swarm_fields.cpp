// The running swarm matches its file: each field of a drone is changed, added and removed, one by one and in pairs.
#include "programs_for_tests.hpp"
#include "worker_swarm.hpp"

#include <doctest/doctest.h>
#include <free_port.hpp>
#include <hive/event/home.hpp>
#include <mute_server.hpp>
#include <possible.hpp>

#include <algorithm>
#include <set>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

constexpr const char* wrapper = "#!/bin/sh\nexec hive-ticker \"$@\"\n";

/// A value for each field of a drone, by its name; some need another field.
Json changes(const Swarm& swarm)
{
    const auto port = std::to_string(free_port());
    const auto key = (swarm.home() / "other.key").string();
    swarm.hivectl_done({"key", "new", "--file", key});
    return {
        {"kind", {{"kind", "wrapper"}}},
        {"set", {{"set", {{"bytes", 200}}}}},
        {"restart", {{"restart", "on-failure"}}},
        {"on_exception", {{"on_exception", "halt"}}},
        {"halted", {{"halted", true}}},
        {"listen", {{"listen", "tcp://127.0.0.1:" + port}, {"insecure", true}}},
        {"advertise", {{"advertise", "tcp://localhost"}, {"listen", "tcp://127.0.0.1:" + port}, {"insecure", true}}},
        {"key", {{"key", key}}},
        {"insecure", {{"insecure", true}}},
        {"no_announce", {{"no_announce", true}}},
        {"remote_operator", {{"remote_operator", true}}},
        {"log_level", {{"log_level", "debug"}}},
        {"cpus", {{"cpus", 2}}},
        {"memory_mib", {{"memory_mib", 512}}},
        {"gpus", {{"gpus", 1}}}};
}

Json file_with(const Json& change = Json::object())
{
    Json drone{{"kind", "ticker"}};
    drone.update(change);
    return {{"swarm", "s"},
            {"drones", {{"t", drone}, {"sink", {{"kind", "sleeper"}}}}},
            {"connections", {{{"from", "t"}, {"to", "sink"}}}}};
}

/// The status of the drone, its export, and its receivers.
Json told(const Swarm& swarm)
{
    auto application = swarm.application();
    const auto status = application.status("t");
    CHECK(eventually([&] { return edges(swarm) == 1; }));
    return {{"order", to_json(status.order.value())},
            {"halted", status.state == hive::State::halted},
            {"policy", token(status.policy)},
            {"parameters", application.get("t")},
            {"export", Json::parse(swarm.hivectl_done({"export"}))}};
}

/// The same for a swarm that is started from this file.
Json told_anew(const Json& content)
{
    const Swarm fresh;
    const File file(fresh, content);
    steps(fresh, file);
    auto result = told(fresh);
    fresh.hivectl_done({"down"});
    return result;
}

}  // namespace

TEST_CASE("up: each field that a file changes runs as in a swarm that is started from the new file")
{
    const Programs programs({"hive-wrapper"}, wrapper);
    const Swarm swarm;
    const auto fields = changes(swarm);
    for (const auto& field : hive::order_fields())
        if (field.change != hive::OrderField::Change::never)
            CHECK_MESSAGE(fields.contains(field.name), field.name, " is not tried");

    std::vector<Json> contents{Json::object()};
    for (auto one = fields.begin(); one != fields.end(); ++one) {
        contents.push_back(*one);
        contents.push_back(Json::object());  // removed again
    }
    for (auto one = fields.begin(); !sanitized() && one != fields.end(); ++one)
        for (auto other = std::next(one); other != fields.end(); ++other) {
            contents.push_back(*one);
            contents.back().update(*other);
        }
    std::map<Json, Json> expected;  // before the swarm takes a port
    for (const auto& content : contents)
        if (!expected.contains(content))
            expected[content] = told_anew(file_with(content));
    const File file(swarm, file_with());
    for (const auto& content : contents) {
        CAPTURE(content.dump());
        file.write(file_with(content));
        const auto announced = swarm.hivectl_done({"up", file, "--dry-run"});
        CHECK_EQ(swarm.hivectl_done({"up", file}, 60'000ms), announced);
        CHECK_EQ(swarm.hivectl_done({"up", file, "--dry-run"}), "");
        CHECK_EQ(told(swarm), expected[content]);
    }
}

TEST_CASE("fields: the page has each, and the help of a drone and of hivectl start has each option")
{
    const Swarm swarm;
    const auto page = text_of(HIVE_SOURCE_DIR "/libhive/docs/swarm-file.md");
    const auto drone = swarm.run({swarm.program("hive-ticker").string(), "--help"}).out;
    const auto start = swarm.hivectl_done({"start", "--help"});
    for (const auto& field : hive::order_fields()) {
        CAPTURE(field.name);
        CHECK(has(page, "| `" + std::string(field.name) + "` |"));
        CHECK(has(drone, std::string(field.option)));
        CHECK(has(start, std::string(field.option)));
    }
}

TEST_CASE("up: what changes at run time needs no new process, and what was done by hand outlives one")
{
    const Swarm swarm;
    auto content = file_with({{"set", {{"bytes", 200}}}});
    const File file(swarm, content);
    steps(swarm, file);
    const auto extra = swarm.drone("sleeper", "extra");
    swarm.hivectl_done({"connect", "t", "extra"});
    swarm.hivectl_done({"set", "t", "fps=50"});
    const auto pid = running(swarm).at("t");

    content["drones"]["t"]["halted"] = true;
    file.write(content);
    CHECK_EQ(swarm.hivectl_done({"up", file}), "change t halted=true\n");
    swarm.hivectl_done({"resume", "t"});
    CHECK_EQ(swarm.hivectl_done({"up", file}), "change t halted=true\n");
    content["drones"]["t"] = {{"kind", "ticker"}, {"on_exception", "halt"}};
    file.write(content);
    CHECK_EQ(swarm.hivectl_done({"up", file}), "change t halted=false on_exception=halt\nset t bytes=1000\n");
    CHECK(running(swarm).at("t") == pid);

    content["drones"]["t"]["log_level"] = "debug";
    file.write(content);
    CHECK_EQ(swarm.hivectl_done({"up", file}), "restart t log_level=debug\n");
    CHECK(running(swarm).at("t") != pid);
    CHECK(has(swarm.log("t"), " debug "));
    CHECK_EQ(swarm.hivectl_done({"get", "t", "fps"}), "50.0\n");
    CHECK(eventually([&] { return edges(swarm) == 2; }));
    swarm.hivectl_done({"halt", "t"});
    CHECK(steps(swarm, file).empty());  // halted by hand, which the file does not set
}

TEST_CASE("up: a restart that fails is undone, with the parameters and connections that the drone had")
{
    const Swarm swarm;
    auto content = file_with({{"set", {{"bytes", 200}}}, {"on_exception", "halt"}});
    const File file(swarm, content);
    steps(swarm, file);
    const auto before = told(swarm);
    const MuteServer other;
    content["drones"]["t"]["listen"] = "tcp://127.0.0.1:" + other.port();
    content["drones"]["t"]["insecure"] = true;
    content["drones"]["t"].erase("set");
    content["connections"] = Json::array();
    file.write(content);
    const auto refused = swarm.hivectl({"up", file}, 60'000ms);
    CHECK(refused.exit_code == 5);
    CHECK_MESSAGE(has(refused.err, "s is unchanged"), refused.err);
    CHECK_EQ(told(swarm), before);
}

TEST_CASE("up: Ctrl-C while a drone is being restarted has it run as before")
{
    const Swarm swarm;
    auto content = file_with();
    const File file(swarm, content);
    steps(swarm, file);
    const auto before = running(swarm);
    auto& sink = content["drones"]["sink"];
    sink["log_level"] = "debug";
    sink["set"] = {{"start_ms", 600'000}, {"work_ms", 2}};
    file.write(content);
    auto up = swarm.hivectl_running({"up", file}, "up");
    const hive::event::Home home(swarm.home());
    REQUIRE(eventually([&] { return home.alive("sink") && home.holder("sink") != before.at("sink"); }));
    up.signal(SIGINT);
    CHECK(up.wait(patient(20'000ms)) == 130);
    CHECK_MESSAGE(has(swarm.log("up"), "s is unchanged"), swarm.log("up"));
    CHECK(eventually([&] { return edges(swarm) == 1; }));
    const auto now = running(swarm);
    CHECK(now.at("t") == before.at("t"));
    CHECK(swarm.application().get("sink", {"work_ms", "start_ms"}) == Json{{"work_ms", 0}, {"start_ms", 0}});
    CHECK(swarm.application().status("sink").order->log_level.empty());
    CHECK(steps(swarm, File(swarm, file_with())).empty());
    CHECK(has_processes(swarm, 2));
}

TEST_CASE("up: a drone of another kind under the name of one that this swarm did not start is left alone")
{
    const Swarm swarm;
    const auto other = swarm.drone("sleeper", "t");
    const File file(swarm, file_with());
    const auto refused = swarm.hivectl({"up", file}, 60'000ms);
    CHECK_MESSAGE(has(refused.err, "t runs already and is a sleeper, not a ticker"), refused.err);
    CHECK(has_processes(swarm, 1));
}

TEST_CASE("up: a Python file and a wrapper are kinds like others: they come up, are exported and are found to run")
{
    if (!possible(sanitized() ? "a build without sanitizers, which Python cannot load" : ""))
        return;
    const Programs programs({"hive-wrapper"}, wrapper);
    const Swarm swarm;
    const auto python = (swarm.home() / "plain.py").string();
    std::ofstream(python) << "import hive\ndrone = hive.Drone('plain', 'Has a number.')\n"
                             "low = drone.parameter('low', 50, help='a number')\ndrone.run()\n";
    const Json content{{"swarm", "s"},
                       {"drones",
                        {{"e", {{"kind", python}, {"set", {{"low", 60}}}}},
                         {"w", {{"kind", "wrapper"}}},
                         {"by-hand", {{"kind", python}}}}}};
    const File file(swarm, content);
    swarm.hivectl_done({"start", python, "--as", "by-hand"});
    CHECK_EQ(steps(swarm, file), std::vector<std::string>{"start e", "start w"});
    CHECK(steps(swarm, file).empty());
    CHECK_EQ(Json::parse(swarm.hivectl_done({"export"}, 60'000ms)), content);
    CHECK_EQ(swarm.hivectl_done({"start", python, "--as", "e", "--if-missing"}), "e\n");
    const auto other = swarm.hivectl({"start", "wrapper", "--as", "e", "--if-missing"});
    CHECK(other.exit_code != 0);
}
