// Oracles of the simulated ground: each accepts valid histories, and reports invalid ones.
#include "../deadline.hpp"
#include "../links.hpp"

#include <doctest/doctest.h>

using namespace hive::simulation;
using namespace std::chrono_literals;

namespace {

const std::string closed = "closed link to a1 at pid 1004: peer ended the connection";
constexpr Time begin{100s};

/// The number of links that a drone logs as ended and that should not have ended.
struct Told {
    Links links{{"source", "a1", "collector"}};

    std::size_t source_says(Time now, const std::string& line = closed)
    {
        links.logged("source", line, now);
        return links.take_problems().size();
    }
};

}  // namespace

TEST_CASE("links: the end of a link without a fault is a problem")
{
    Told told;
    CHECK(told.source_says(begin) == 1);
    CHECK(told.source_says(begin, "lost receiver a1 at pid 1004: no sign of life for 2 s") == 1);
    CHECK(told.source_says(begin, "closed pid 1004: malformed") == 1);
    CHECK(told.source_says(begin, "closed link to setter-7 at pid 1009: peer ended the connection") == 0);
    CHECK(told.source_says(begin, "started") == 0);
}

TEST_CASE("links: a fault at either end counts while it lasts, and a while longer")
{
    for (const auto* const name : {"source", "a1"}) {
        Told told;
        told.links.broken(name, begin);
        CHECK(told.source_says(begin - 1ms) == 1);
        CHECK(told.source_says(begin + 9s) == 0);
        told.links.mended(name, begin + 10s);
        CHECK(told.source_says(begin + 10500ms) == 0);
        CHECK(told.source_says(begin + 12s) == 1);
    }
    Told told;
    told.links.broken("collector", begin);
    CHECK(told.source_says(begin) == 1);
}

TEST_CASE("links: a cut counts for the two")
{
    Told told;
    told.links.cut("a1", "source", begin);
    CHECK(told.source_says(begin + 1ms) == 0);
    CHECK(told.source_says(begin + 1ms, "closed link to collector at pid 1001: peer ended the connection") == 1);
    CHECK(told.source_says(begin + 2s) == 1);
}

TEST_CASE("links: a peer that was frozen is lost after 2 s of silence, and notices late what happened meanwhile")
{
    Told told;
    told.links.frozen("a1", begin);
    CHECK(told.source_says(begin + 1s) == 1);
    CHECK(told.source_says(begin + 2s) == 0);
    told.links.thawed("a1", begin + 3s);
    CHECK(told.source_says(begin + 3s) == 0);
    CHECK(told.source_says(begin + 5s) == 1);

    told.links.frozen("a1", begin + 10s);
    told.links.cut("a1", "source", begin + 10s);
    told.links.thawed("a1", begin + 10900ms);
    CHECK(told.source_says(begin + 11500ms) == 0);
    CHECK(told.source_says(begin + 12s) == 1);

    told.links.frozen("a1", begin + 20s);
    told.links.thawed("a1", begin + 21s);
    told.links.frozen("a1", begin + 21s);  // it has said nothing in between
    CHECK(told.source_says(begin + 22s) == 0);
}

TEST_CASE("deadline: a call that takes longer than the timeout is a problem, also when it throws")
{
    World world(1);
    Deadline calls(1s);
    std::vector<std::string> problems;
    world.spawn("operator", [&] {
        CHECK(calls.keep("get", [&] { return world.sleep(1s), 7; }) == 7);
        CHECK(calls.take_problems().empty());
        CHECK_THROWS(calls.keep("set", [&] { world.sleep(2s), throw std::runtime_error("refused"); }));
        problems = calls.take_problems();
    });
    for (const auto limit = world.now() + 10s; world.step(limit);) {
    }
    CHECK(problems == std::vector<std::string>{"deadline: set took 2000 ms"});
}
