// hivectl graph: the drones and connections of a swarm, in each form.
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>

using namespace hive::test;
using hive::Json;

namespace {

std::string graph(const Swarm& swarm, const std::string& form)
{
    const auto done = swarm.hivectl({"graph", "--as", form});
    CHECK_MESSAGE(done.exit_code == 0, done.err);
    return done.out;
}

std::string state_of(const Json& graph, const std::string& drone)
{
    for (const auto& each : graph.at("drones"))
        if (each.at("name") == drone)
            return each.at("state");
    return "";
}

/// @param to  the beginning is enough: the name of an application has its process in it
bool has_connection(const Json& graph, const std::string& from, const std::string& to)
{
    return std::ranges::any_of(graph.at("connections"), [&](const Json& each) {
        return each.at("from") == from && each.at("to").get<std::string>().starts_with(to);
    });
}

}  // namespace

TEST_CASE("graph: drones, connections, groups and applications, also while they change")
{
    const Swarm swarm;
    CHECK(has(swarm.hivectl({"graph"}).err, "no drones"));
    const auto source = swarm.drone("ticker", "source"), one = swarm.drone("sleeper", "one"),
               alone = swarm.drone("sleeper", "alone");
    const auto two = swarm.drone("sleeper", "two");
    auto application = swarm.application();
    application.connect({"source", ""}, {"one", ""});
    application.connect({"source", ""}, {"two", ""}, {.group = "workers", .lease = {}});
    application.halt("one");
    const auto results = swarm.hivectl_running({"results", "two"}, "results");
    CHECK(eventually([&] { return has_connection(Json::parse(graph(swarm, "json")), "two.result", "app-"); }));

    const auto text = graph(swarm, "text");
    CHECK_MESSAGE(text.find("local:\n") == 0, text);
    CHECK_MESSAGE(has(text, "  one (sleeper, halted)\n"), text);
    CHECK_MESSAGE(has(text, "    tick -> two.image (group workers)\n"), text);
    CHECK_MESSAGE(has(text, "  alone (sleeper, idle)\n"), text);

    SUBCASE("a drone that hangs is silent, and what others know of it stays")
    {
        two.signal(SIGSTOP);
        const auto now = Json::parse(graph(swarm, "json"));
        const auto silent =
            std::ranges::find(now.at("drones"), Json("two"), [](const Json& drone) { return drone.at("name"); });
        REQUIRE(silent != now.at("drones").end());
        CHECK(silent->at("state") == "silent");
        CHECK(has_connection(now, "source.tick", "two.image"));
        two.signal(SIGCONT);
    }
    SUBCASE("what is disconnected is gone")
    {
        application.disconnect({"source", ""}, {"two", ""});
        CHECK_FALSE(has_connection(Json::parse(graph(swarm, "json")), "source.tick", "two.image"));
        CHECK(has_connection(Json::parse(graph(swarm, "json")), "source.tick", "one.image"));
    }
    SUBCASE("Graphviz draws it")
    {
        const auto drawn = swarm.hivectl({"graph", "--as", "svg"});
        if (drawn.exit_code == 3) {  // this machine has no Graphviz
            CHECK_MESSAGE(has(drawn.err, "apt install graphviz"), drawn.err);
            return;
        }
        const auto& svg = drawn.out;
        CHECK(has(svg, "<svg"));
        for (const char* word : {">source<", ">sleeper, halted<", ">tick (group workers)<", ">local<"})
            CHECK_MESSAGE(has(svg, word), word);
    }
}

TEST_CASE("graph: a drone that crashed or was killed stays until it is stopped, with its connection")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source");
    auto boom = swarm.drone("crasher", "boom"), killed = swarm.drone("sleeper", "killed");
    auto application = swarm.application();
    const auto now = [&] { return Json::parse(graph(swarm, "json")); };
    application.connect({"source", ""}, {"killed", ""});
    application.connect({"source", ""}, {"boom", ""});
    killed.signal(SIGKILL);
    REQUIRE(killed.wait(patient(std::chrono::seconds(10))));
    REQUIRE(boom.wait(patient(std::chrono::seconds(10))));
    for (const auto* name : {"boom", "killed"}) {
        CAPTURE(name);
        CHECK(state_of(now(), name) == "crashed");
        CHECK(eventually([&] { return has(graph(swarm, "text"), std::string(name) + ".i"); }));
        CHECK(has(graph(swarm, "text"), "  " + std::string(name) + " (crashed)\n"));
    }
    const auto again = swarm.drone("sleeper", "killed");
    CHECK(state_of(now(), "killed") != "crashed");
    CHECK(eventually([&] { return has(graph(swarm, "text"), "    tick -> killed.image\n"); }));
    swarm.hivectl_done({"stop", "boom"});
    CHECK(state_of(now(), "boom") == "");
}
