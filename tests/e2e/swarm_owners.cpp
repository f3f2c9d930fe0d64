// Ownership of drones: another swarm uses a drone, but neither changes nor stops it.
#include "worker_swarm.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// One receiver of the source shared by both swarms.
Json file_of(const std::string& swarm, int fps)
{
    return {{"swarm", swarm},
            {"drones",
             {{"source", {{"kind", "ticker"}, {"set", {{"fps", fps}}}}}, {swarm + "-sink", {{"kind", "sleeper"}}}}},
            {"connections", {{{"from", "source"}, {"to", swarm + "-sink"}}}}};
}

std::string swarm_of(const Swarm& swarm, const std::string& drone)
{
    return Json::parse(swarm.hivectl_done({"ps", drone, "--json"})).at(0).at("swarm");
}

}  // namespace

TEST_CASE("owners: a second swarm connects the drone of another one as it is, and down of it leaves that drone")
{
    const Swarm swarm;
    const File file(swarm, file_of("one", 50));
    steps(swarm, file);
    CHECK(swarm_of(swarm, "source") == "one");
    file.write(file_of("two", 20));
    const auto up = swarm.hivectl({"up", file});
    CHECK(up.out == "start two-sink\nconnect source.tick -> two-sink.image\n");
    CHECK_MESSAGE(has(up.err, "source runs already, brought up by the swarm one, and is used as it is, without fps=20"),
                  up.err);
    CHECK(swarm.hivectl_done({"get", "source", "fps"}) == "50.0\n");
    CHECK(steps(swarm, file).empty());
    file.write(file_of("one", 50));
    CHECK(steps(swarm, file).empty());

    file.write(file_of("two", 20));
    const auto down = swarm.hivectl({"down", file});
    CHECK(down.exit_code == 0);
    CHECK(down.out == "two-sink\n");
    CHECK_MESSAGE(has(down.err, "source was brought up by the swarm one, so it is left alone"), down.err);
    CHECK(running(swarm).size() == 2);
    CHECK(lines_of(swarm.hivectl_done({"down"})) == 2);
    CHECK(has_processes(swarm, 0));
}

TEST_CASE("owners: change_if_shared sets parameters and options of connections of another swarm's drone")
{
    const Swarm swarm;
    const File file(swarm, file_of("one", 50));
    steps(swarm, file);
    auto two = file_of("two", 20);
    two["drones"]["one-sink"] = {{"kind", "sleeper"}};
    two["connections"].push_back({{"from", "source"}, {"to", "one-sink"}, {"window", 3}});
    file.write(two);
    CHECK(swarm.hivectl_done({"up", file}) == "start two-sink\nconnect source.tick -> two-sink.image\n");
    two["drones"]["source"]["change_if_shared"] = two["drones"]["one-sink"]["change_if_shared"] = true;
    file.write(two);
    CHECK(swarm.hivectl_done({"up", file}) == "set source fps=20\nconnect source.tick -> one-sink.image\n");
    CHECK(steps(swarm, file).empty());
    two["connections"].erase(1);
    two["drones"]["one-sink"].erase("change_if_shared");
    file.write(two);
    CHECK(steps(swarm, file).empty());
    two["drones"].erase("source");
    two["drones"].erase("one-sink");
    two["connections"].clear();
    file.write(two);
    CHECK(steps(swarm, file).empty());
    CHECK(running(swarm).size() == 3);
}

TEST_CASE("owners: down of a file that was refused, or whose drones were started by hand, ends nothing")
{
    const Swarm swarm;
    const auto other = swarm.drone("ticker", "source");
    const File file(swarm, {{"swarm", "one"}, {"drones", {{"source", {{"kind", "sleeper"}}}}}});
    CHECK(swarm.hivectl({"up", file}).exit_code != 0);
    const auto refused = swarm.hivectl({"down", file});
    CHECK(refused.out.empty());
    CHECK_MESSAGE(has(refused.err, "brought up by no swarm"), refused.err);
    file.write(file_of("one", 50));
    CHECK(steps(swarm, file).size() == 2);
    CHECK(swarm.hivectl_done({"down"}) == "one-sink\n");
    CHECK(has_processes(swarm, 1));
}

TEST_CASE("owners: a record that cannot be read keeps no other swarm from being exported and stopped")
{
    const Swarm swarm;
    const File file(swarm, workers_file(1));
    steps(swarm, file);
    std::ofstream(swarm.home() / "broken.swarm") << '{';
    for (const std::string verb : {"export", "down"}) {
        const auto done = swarm.hivectl({verb});
        CHECK(done.exit_code == (verb == "export" ? 0 : 8));
        CHECK(has(done.err, "broken.swarm remembers cannot be read"));
    }
    CHECK(has_processes(swarm, 0));
}

TEST_CASE("owners: a drone stays with its swarm when it crashes and is started by hand, and when it is replaced")
{
    const Swarm swarm;
    const File file(swarm, file_of("one", 50));
    steps(swarm, file);
    swarm.hivectl_done({"replace", "source"});
    CHECK(swarm_of(swarm, "source") == "one");
    ::kill(static_cast<pid_t>(running(swarm).at("source")), SIGKILL);
    REQUIRE(eventually([&] { return running(swarm).count("source") == 0; }));
    swarm.hivectl_done({"start", "ticker", "--as", "source"});
    CHECK(swarm_of(swarm, "source") == "one");
    CHECK(lines_of(swarm.hivectl_done({"down"})) == 2);
    swarm.hivectl_done({"start", "ticker", "--as", "source", "--swarm", "one"});
    CHECK(swarm.hivectl_done({"down", file}) == "source\n");
    CHECK(has_processes(swarm, 0));
}

TEST_CASE("owners: a drone of another swarm that does not answer is not ended when it does")
{
    const Swarm swarm;
    const File file(swarm, file_of("one", 50));
    steps(swarm, file);
    file.write(file_of("two", 50));
    steps(swarm, file);
    auto application = swarm.application();
    const auto answers = application.stop({"source", "two-sink"}, "two");
    const auto* error = error_of(answers.at(0).result);
    REQUIRE(error);
    CHECK(error->code() == hive::Errc::refused);
    CHECK(!error_of(answers.at(1).result));
    CHECK(running(swarm).size() == 2);
}

TEST_CASE("owners: up --stay leaves a drone of another swarm that crashed to that swarm")
{
    const Swarm swarm;
    const File file(swarm, file_of("one", 50));
    steps(swarm, file);
    auto two = file_of("two", 50);
    for (auto& drone : two["drones"])
        drone["restart"] = "on-failure";
    file.write(two);
    auto stay = swarm.hivectl_running({"up", file, "--stay"}, "stay");
    REQUIRE(eventually([&] { return running(swarm).count("two-sink") == 1 && edges(swarm) == 2; }));
    std::this_thread::sleep_for(500ms);  // it has checked by then
    ::kill(static_cast<pid_t>(running(swarm).at("source")), SIGKILL);
    ::kill(static_cast<pid_t>(running(swarm).at("two-sink")), SIGKILL);
    REQUIRE(eventually([&] { return has(swarm.log("stay"), "two-sink crashed and was restarted"); }, 20'000ms));
    CHECK(running(swarm).count("source") == 0);
    CHECK(!has(swarm.log("stay"), "source crashed"));
    stay.signal(SIGINT);
    CHECK(stay.wait(patient(5000ms)) == 0);
}
