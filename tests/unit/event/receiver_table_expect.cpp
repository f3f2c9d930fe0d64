// Receivers of an earlier run of a drone: its source waits for them, for 30 s or until they come.
#include "table_fixtures.hpp"

#include <doctest/doctest.h>

namespace hive::event {

using namespace std::chrono_literals;

namespace {

void expect(World& world, const std::string& receiver, const std::string& group = "",
            std::optional<Clock::duration> timeout = 30s)
{
    world.table.expect({.output = "image", .receiver = receiver, .group = group},
                       timeout ? std::optional(world.now + *timeout) : std::nullopt);
}

Newcomer drone(ReceiverId id, const std::string& receiver, const ConnectionOptions& options = window(1))
{
    return {.id = id, .receiver = receiver, .options = options, .unique = true};
}

}  // namespace

TEST_CASE("expect: each that an earlier run had gets every event, whoever comes first")
{
    World world;
    expect(world, "x.image");
    expect(world, "y.image");
    CHECK(world.table.why() == Reason::place_kept);
    CHECK(world.table.demand().fans_out);
    CHECK(world.offer(1, true).empty());
    CHECK(world.add(drone(3, "x.image")) == Got{{3, {1}}});
    CHECK(world.ask(3, {2, 1, 1}).empty());
    CHECK_FALSE(world.table.demand().asked);
    CHECK(world.add(drone(4, "y.image")) == Got{{4, {1}}});
    CHECK(world.ask(4, {2, 1, 1}).empty());
    CHECK(world.table.demand().asked);
    CHECK(world.row("y.image").events.of(Fate::acknowledged) == 1);
}

TEST_CASE("expect: two applications of one name, and a third that nobody expected")
{
    World world;
    expect(world, "hivectl");
    expect(world, "hivectl");
    world.offer(1, true);
    CHECK(world.add(3, "hivectl", window(1)) == Got{{3, {1}}});
    CHECK(world.add(4, "hivectl", window(1)) == Got{{4, {1}}});
    CHECK(world.add(5, "hivectl", window(1)).empty());
    CHECK(world.offer(2, true) == Got{{5, {2}}});
    CHECK(world.table.subscribers().size() == 3);
}

TEST_CASE("expect: one that does not come is waited for as long as was said, and its events are counted as lost")
{
    World world;
    expect(world, "x.image");
    expect(world, "y.image", "", std::nullopt);
    world.offer(1, true);
    world.pass(29s);
    CHECK(world.table.subscribers().size() == 2);
    world.pass(2s);
    const auto dormant = world.table.subscribers();
    REQUIRE(dormant.size() == 2);
    CHECK(dormant[0] == Subscriber{.output = {}, .receiver = "x.image", .missed = {1, "camera", 1}, .dormant = true});
    CHECK(dormant[1] == Subscriber{.output = {}, .receiver = "y.image"});
    CHECK(world.row("x.image").events.of(Fate::lost_connection) == 1);
    world.pass(1h);
    CHECK(world.table.why() == Reason::place_kept);
    CHECK(world.forget("y") == 1);
    CHECK(world.table.why() == Reason::no_receiver);
    CHECK_FALSE(world.table.timed());
}

TEST_CASE("expect: what a receiver missed is counted on when its sender crashes")
{
    World before, after;
    before.add(drone(1, "x.image"));
    before.add(drone(2, "y.image"));
    before.lose(1, Fate::lost_cut_off);
    before.offer(1, true);
    before.ask(2, {2, 1, 1});
    before.pass(31s);
    CHECK(before.table.timed());
    before.pass(20ms);
    CHECK_FALSE(before.table.timed());
    before.offer(2, true);
    CHECK(before.table.timed());  // so that the count is soon written down
    for (const auto& subscriber : before.table.subscribers())
        after.table.expect(subscriber, after.now + 30s);
    CHECK(after.offer(3, true).empty());  // y is waited for, x is not
    CHECK(after.add(drone(3, "y.image")) == Got{{3, {3}}});
    after.ask(3, {2, 1, 1});
    CHECK(after.table.demand().asked);
    CHECK(after.add(drone(4, "x.image")).empty());
    CHECK(after.table.missed(4) == 3);
    CHECK(after.table.missed(3) == 0);
    CHECK(after.table.subscribers()[0].missed == Subscription::Missed{3, "camera", 1});
}

TEST_CASE("expect: what an application misses of a live source is not remembered")
{
    World world;
    world.add(1, "results", window(1));
    world.offer(1);
    world.lose(1, Fate::lost_cut_off);
    CHECK(world.table.subscribers().empty());
}

TEST_CASE("expect: a live source waits for nobody")
{
    World world;
    expect(world, "x.image");
    world.offer(1);
    CHECK(world.table.why() == Reason::no_receiver);
    CHECK(world.add(drone(2, "x.image")).empty());
    CHECK(world.offer(2) == Got{{2, {2}}});
}

TEST_CASE("expect: a group is there when the first of its members is, and gives up what waits when none comes")
{
    World world;
    expect(world, "x.image", "workers");
    expect(world, "y.image", "workers");
    world.offer(1, true);
    CHECK(world.table.why() == Reason::group_awaited);
    CHECK(world.add(drone(3, "y.image", sharing(1))) == Got{{3, {1}}});
    CHECK(world.table.subscribers().size() == 2);
    World alone;
    expect(alone, "x.image", "workers");
    alone.offer(1, true);
    alone.pass(31s);
    CHECK(alone.failed == Sequences{1});
    CHECK(alone.table.why() == Reason::no_receiver);
}

TEST_CASE(
    "expect: of a group, one comes and leaves before the others are there: they are waited for, as long as was said")
{
    World world;
    expect(world, "x.image", "workers");
    expect(world, "y.image", "workers");
    world.add(drone(3, "y.image", sharing(1)));
    world.add(drone(9, "z.image", window(64)));
    world.pass(20s);
    world.leave(3);
    world.offer(1, true);
    CHECK(world.table.why() == Reason::group_awaited);
    SUBCASE("one comes") { CHECK(world.add(drone(4, "x.image", sharing(1))) == Got{{4, {1}}}); }
    SUBCASE("none comes")
    {
        world.pass(11s);
        CHECK(world.failed == Sequences{1});
        CHECK(world.table.why() != Reason::group_awaited);
    }
}

TEST_CASE("expect: who is remembered is whom the source waits for, and no one else")
{
    World world;
    world.add(drone(1, "x.image"));
    world.add(drone(2, "w1.image", sharing(1)));
    world.add(drone(3, "watcher.image", streaming(Delivery::notification)));
    world.add({.id = 4, .receiver = "viewer", .options = window(1), .guest = true});
    world.add(drone(5, "gone.image"));
    world.add(drone(6, "cut.image"));
    world.offer(1, true);
    world.leave(5);
    world.lose(6, Fate::lost_cut_off);
    world.lose(2, Fate::lost_killed);
    std::vector<std::string> names;
    for (const auto& each : world.table.subscribers())
        names.push_back(each.receiver + each.group);
    CHECK(names == std::vector<std::string>{"x.image", "cut.image", "w1.imageworkers"});
}

}  // namespace hive::event
