// hivectl advise: the steps, the bottleneck, a command that helps, and no proposal if none helps.
#include "measure.hpp"
#include "status_sums.hpp"

#include <doctest/doctest.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// The first line of drones.
Json advised(const Swarm& swarm, const std::vector<std::string>& words)
{
    std::vector<std::string> all{"advise", "--json", "--time", "0.5"};
    all.insert(all.end(), words.begin(), words.end());
    const auto advice = Json::parse(swarm.hivectl_done(all));
    REQUIRE_MESSAGE(!advice.at("lines").empty(), advice.dump());
    return advice.at("lines").at(0);
}

std::string whats(const Json& line, const char* array)
{
    std::string text;
    for (const auto& each : line.at(array))
        text += (text.empty() ? "" : " ") + each.at("what").get<std::string>();
    return text;
}

}  // namespace

TEST_CASE("advise: a slow worker is the bottleneck, and the command that is proposed shares its work")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"}),
               worker = swarm.drone("sleeper", "worker", {"work_ms=40"}), last = swarm.drone("sleeper", "last");
    CHECK(swarm.hivectl({"advise"}).exit_code == 0);
    CHECK(has(swarm.hivectl({"advise"}).err, "no drone receives"));
    CHECK(has(swarm.hivectl({"advise", "last"}).err, "last receives from no drone"));
    CHECK(has(swarm.hivectl({"advise", "nobody"}).err, "nobody"));
    swarm.hivectl_done({"connect", "source", "worker"});
    swarm.hivectl_done({"connect", "worker", "last"});
    auto application = swarm.application();
    const auto done = [&] { return at_inputs(application.status("last"), &hive::InputStatus::processed); };
    REQUIRE(eventually([&] { return done() > 3; }));

    const auto line = advised(swarm, {});
    INFO(line.dump(2));
    CHECK(line.at("from") == "source");
    CHECK(line.at("to") == "last");
    CHECK(whats(line, "stations").starts_with("source waiting"));
    CHECK(line.at("limits").at(0).at("what") == "work");
    CHECK(line.at("limits").at(0).at("at") == "worker");
    CHECK(line.at("latency_us").get<int>() >= 40'000);
    const auto& first = line.at("proposals").at(0);
    CHECK(first.at("what") == "worker");
    CHECK(first.at("predicted_per_s").get<double>() > 1.5 * line.at("per_s").get<double>());
    const auto ran = swarm.run({"/bin/sh", "-c", first.at("command").get<std::string>()});
    REQUIRE_MESSAGE(ran.exit_code == 0, ran.err);
    const auto shared = advised(swarm, {"source", "last"});
    CHECK_MESSAGE(shared.at("per_s").get<double>() > 1.5 * line.at("per_s").get<double>(), shared.dump(2));
    CHECK(shared.at("limits").at(0).at("at") == "worker, worker-2");
    CHECK(application.get("worker-2", {"work_ms"}).at("work_ms") == 40);

    application.set("source", {{"fps", 10}});
    const auto idle = advised(swarm, {"last"});
    CHECK_MESSAGE(idle.at("limits").at(0).at("what") == "source", idle.dump(2));
    CHECK(idle.at("proposals").empty());
    CHECK(has(swarm.hivectl_done({"advise", "last", "--time", "1"}), "nothing to gain"));
    CHECK(has(swarm.hivectl({"advise", "last", "worker"}).err, "no events go from last to worker"));
}

TEST_CASE("advise: events that were requested ahead wait, which is what latency is about")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"}),
               worker = swarm.drone("sleeper", "worker", {"work_ms=20"});
    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""}, {.window = 4, .group = {}, .lease = {}});
    REQUIRE(eventually([&] { return at_inputs(application.status("worker"), &hive::InputStatus::processed) > 10; }));
    const auto line = advised(swarm, {"worker", "--goal", "latency"});
    INFO(line.dump(2));
    CHECK(has(whats(line, "stations"), "queue work"));
    const auto& proposals = line.at("proposals");
    CHECK(has(whats(line, "proposals"), "window"));
    CHECK(has(whats(line, "proposals"), "source_rate"));
    for (const auto& proposal : proposals)
        CHECK(proposal.at("predicted_us").get<int>() < line.at("latency_us").get<int>() / 2);
}

TEST_CASE("advise: a source on demand is as fast as the slowest of those that receive from it")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"}),
               worker = swarm.drone("sleeper", "worker", {"work_ms=40"}),
               last = swarm.drone("sleeper", "last", {"work_ms=10", "emits=false"});
    auto application = swarm.application();
    application.connect({"worker", ""}, {"last", ""});
    application.connect({"source", ""}, {"worker", ""});
    REQUIRE(eventually([&] { return at_inputs(application.status("last"), &hive::InputStatus::processed) > 3; }));
    const auto line = advised(swarm, {"last"});
    INFO(line.dump(2));
    CHECK(line.at("limits").at(0).at("at") == "worker");
    REQUIRE(whats(line, "proposals") == "worker");
    CHECK(line.at("proposals").at(0).at("predicted_per_s").get<double>() > 1.8 * line.at("per_s").get<double>());
}
