// A receiver that joins a group, leaves one or changes groups: what waits for it goes along, and what it has in hand it
// deals with where it got it.
#include "table_fixtures.hpp"

#include <doctest/doctest.h>

namespace hive::event {

namespace {

Newcomer face(ReceiverId id, const ConnectionOptions& options, bool drains = true)
{
    return {.id = id, .receiver = "face.image", .options = options, .unique = true, .drains = drains};
}

Sequences from_to(std::int64_t first, std::int64_t last)
{
    Sequences all;
    for (auto i = first; i <= last; ++i)
        all.push_back(i);
    return all;
}

}  // namespace

TEST_CASE(
    "regroup: what waits for a plain receiver that joins a group waits in the group, and what it has in hand stays")
{
    World world;
    world.add(face(1, window(2)));
    for (int i = 1; i <= 10; ++i)
        world.offer(i, true);
    CHECK(world.add(face(2, sharing(4))) == Got{{2, from_to(3, 6)}});
    CHECK_FALSE(world.welcome.ends);  // the old registration deals with events 1 and 2
    CHECK(world.ask(1, {4, 2, 2}).empty());
    CHECK(world.row("face.image").connected);
    world.leave(1);
    CHECK(world.ask(2, {8, 4, 4}) == Got{{2, from_to(7, 10)}});
    CHECK(world.ask(2, {12, 8, 8}).empty());
    CHECK(world.table.demand().asked);
    CHECK(world.failed.empty());
    CHECK(world.row("group workers").events.of(Fate::acknowledged) == 8);
}

TEST_CASE("regroup: what a plain receiver has in hand and does not do goes to the group that it has joined")
{
    World world;
    world.add(face(1, window(2)));
    world.offer(1, true);
    world.offer(2, true);
    world.add(face(2, sharing(4)));
    world.ask(1, {3, 1, 1});
    CHECK(world.lose(1, Fate::lost_cut_off) == Got{{2, {2}}});
    CHECK(world.table.why() != Reason::place_kept);
    world.ask(2, {5, 1, 1});
    CHECK(world.table.demand().asked);
}

TEST_CASE("regroup: what a plain receiver may have answered when its connection was lost is not given up in its group")
{
    World world;
    world.add(face(1, window(2)));
    world.offer(1, true);
    world.offer(2, true);
    world.add(face(2, sharing(4)));
    SUBCASE("lost")
    {
        CHECK(world.lose(1, Fate::lost_connection) == Got{{2, {1, 2}}});
        world.leave(2);
        CHECK(world.failed.empty());
    }
    SUBCASE("left: it answers nothing more")
    {
        CHECK(world.leave(1) == Got{{2, {1, 2}}});
        world.leave(2);
        CHECK(world.failed == Sequences{1, 2});
    }
    SUBCASE("lost, and left when it had changed back and again")
    {
        world.lose(1, Fate::lost_connection);
        world.add(face(3, window(2)));
        CHECK(world.leave(2) == Got{{3, {1, 2}}});
        world.add(face(4, sharing(4)));
        CHECK(world.leave(3) == Got{{4, {1, 2}}});
        world.leave(4);
        CHECK(world.failed.empty());
    }
}

TEST_CASE("regroup: what a receiver has in hand goes to where it stands now, also when it changed twice meanwhile")
{
    World world;
    world.add(face(1, window(2)));
    world.offer(1, true);
    world.offer(2, true);
    world.add(face(2, sharing(4)));
    world.add(face(3, window(4)));
    ReceiverId last = 3;
    SUBCASE("from a group that it has left by now") { world.leave(2); }
    SUBCASE("and then the options of its place")
    {
        world.leave(2);
        auto again = face(last = 4, window(8));
        again.place = world.welcome.place;
        again.taken = 0;
        world.add(again);
    }
    CHECK(world.lose(1, Fate::lost_connection) == Got{{last, {1, 2}}});
    CHECK(world.table.why() != Reason::place_kept);
    world.ask(last, {6, 2, 2});
    CHECK(world.table.demand().asked);
}

TEST_CASE("regroup: what a receiver has in hand goes to its next connection, if it was disconnected meanwhile")
{
    World world;
    world.add(face(1, window(2)));
    world.offer(1, true);
    world.offer(2, true);
    world.add(face(2, sharing(4)));
    world.leave(2);
    world.add(face(3, window(4), false));
    CHECK(world.lose(1, Fate::lost_connection) == Got{{3, {1, 2}}});
    CHECK(world.table.why() != Reason::place_kept);
    world.ask(3, {6, 2, 2});
    CHECK(world.table.demand().asked);
}

TEST_CASE("regroup: a member that was disconnected with something in hand takes it along when it is connected again")
{
    World world;
    world.add(face(1, sharing(2)));
    world.offer(1, true);
    world.offer(2, true);
    world.add(face(2, window(4)));
    world.leave(2);
    CHECK(world.lose(1, Fate::lost_connection).empty());
    CHECK(world.add(face(3, window(4), false)) == Got{{3, {1, 2}}});
    CHECK(world.table.why() != Reason::group_awaited);
}

TEST_CASE("regroup: a source waits for no group whose last member is received plainly now")
{
    World world;
    world.add(face(1, sharing(1)));
    for (int i = 1; i <= 3; ++i)
        world.offer(i, true);
    CHECK(world.add(face(2, window(4))) == Got{{2, {2, 3}}});
    CHECK_FALSE(world.row("group workers").connected);
    CHECK(world.offer(4, true) == Got{{2, {4}}});
    world.ask(1, {1, 1, 1});
    world.leave(1);
    world.ask(2, {7, 3, 3});
    CHECK(world.table.demand().asked);
    CHECK(world.failed.empty());
    CHECK(world.row("group workers").events.in_flight() == 0);
}

TEST_CASE("regroup: of a group that goes on nothing is taken along")
{
    World world;
    world.add(face(1, sharing(1)));
    world.add({.id = 9, .receiver = "other.image", .options = sharing(1), .unique = true});
    for (int i = 1; i <= 4; ++i)
        world.offer(i, true);
    CHECK(world.add(face(2, window(4))).empty());
    CHECK(world.ask(9, {2, 1, 1}) == Got{{9, {3}}});
    world.leave(1);  // with event 1 in hand
    CHECK(world.ask(9, {3, 2, 2}) == Got{{9, {1}}});
    CHECK(world.offer(5, true) == Got{{2, {5}}});
}

TEST_CASE("regroup: a killed member that is back as a plain receiver gets what its group waited with")
{
    World world;
    world.add(face(1, sharing(1)));
    world.offer(1, true);
    world.offer(2, true);
    world.lose(1, Fate::lost_killed);
    CHECK(world.table.why() == Reason::group_awaited);
    CHECK(world.add(face(2, window(4), false)) == Got{{2, {1, 2}}});
    world.ask(2, {6, 2, 2});
    CHECK(world.table.demand().asked);
}

TEST_CASE("regroup: a member that left takes along what may have been answered when it is connected plainly")
{
    World world;
    world.add(face(1, sharing(2)));
    world.offer(1, true);
    world.offer(2, true);
    world.lose(1, Fate::lost_connection);
    CHECK(world.add(face(2, sharing(2), false)) == Got{{2, {1, 2}}});
    world.leave(2);
    CHECK(world.failed.empty());
    CHECK(world.add(face(3, window(4), false)) == Got{{3, {1, 2}}});
    CHECK(world.row("group workers").events.in_flight() == 0);
}

TEST_CASE("regroup: a group waits on for a member that did not come back as a plain receiver")
{
    World world;
    world.add(face(1, sharing(1)));
    world.add({.id = 9, .receiver = "other.image", .options = sharing(1), .unique = true});
    world.offer(1, true);
    world.lose(1, Fate::lost_killed);
    world.lose(9, Fate::lost_killed);
    CHECK(world.add(face(2, window(4), false)).empty());
    CHECK(world.table.why() == Reason::group_awaited);
    CHECK(world.add({.id = 10, .receiver = "other.image", .options = sharing(1), .unique = true}) == Got{{10, {1}}});
}

TEST_CASE("regroup: a restarted plain receiver that joins a group does not leave its place waiting")
{
    World world;
    world.add(face(1, window(2)));
    for (int i = 1; i <= 3; ++i)
        world.offer(i, true);
    world.lose(1, Fate::lost_killed);
    CHECK(world.add(face(2, sharing(4), false)) == Got{{2, {1, 2, 3}}});
    world.ask(2, {7, 3, 3});
    CHECK(world.table.demand().asked);
    CHECK_FALSE(world.table.timed());
}

TEST_CASE("regroup: from one group to another")
{
    auto others = sharing(4);
    others.group = "others";
    World world;
    world.add(face(1, sharing(1)));
    for (int i = 1; i <= 3; ++i)
        world.offer(i, true);
    CHECK(world.add(face(2, others)) == Got{{2, {2, 3}}});
    world.ask(1, {2, 1, 1});
    world.leave(1);
    world.ask(2, {6, 2, 2});
    CHECK(world.table.demand().asked);
    CHECK(world.offer(4, true) == Got{{2, {4}}});
}

TEST_CASE("regroup: what goes along after the end was told revokes it, and the end is told again behind that")
{
    World world;
    world.add(face(1, sharing(1)));
    world.offer(1, true);
    world.offer(2, true);
    CHECK(decided([&](Decisions& to) { world.table.end(world.now, to); }).ends.empty());
    CHECK(world.add(face(2, window(2))) == Got{{2, {2}}});
    CHECK(world.table.told_end(2));
    CHECK(world.ask(1, {1, 1, 1}, {1}).empty());
    const auto decisions = decided([&](Decisions& to) { world.table.leave(1, world.now, to); });
    CHECK(sequences(decisions) == Sequences{1});
    CHECK(decisions.revoked == std::vector<ReceiverId>{2});
    CHECK(decisions.ends == std::vector<ReceiverId>{2});
}

TEST_CASE("regroup: from a receiver of notifications nothing goes along, and to one neither")
{
    auto watching = window(1);
    watching.delivery = Delivery::notification;
    World joins;
    joins.add(face(1, watching));
    joins.offer(1, true);
    joins.offer(2, true);
    CHECK(joins.add(face(2, sharing(4))).empty());
    joins.leave(1);
    CHECK(joins.offer(3, true) == Got{{2, {3}}});
    World leaves;
    leaves.add(face(1, sharing(1)));
    leaves.offer(1, true);
    leaves.offer(2, true);
    CHECK(leaves.add(face(2, watching)).empty());
    CHECK(leaves.row("group workers").why == Reason::not_acknowledged);
    CHECK(leaves.table.why() == Reason::watched);  // the source waits for nobody
    leaves.leave(1);
    CHECK(leaves.failed == Sequences{1, 2});
    CHECK_FALSE(leaves.table.awaited());
}

TEST_CASE("regroup: changing the options of a plain receiver loses nothing, not even what is live and waits")
{
    World world;
    world.add(face(1, window(1)));
    world.offer(1);
    world.offer(2);
    auto again = face(2, window(4));
    again.place = world.welcome.place;
    again.taken = 1;
    CHECK(world.add(again) == Got{{2, {2}}});
    CHECK(world.welcome.ends == ReceiverId{1});
    world.ask(2, {6, 2, 2});
    CHECK(world.row("face.image").events.of(Fate::acknowledged) == 2);
    CHECK(world.row("face.image").events.lost() == 0);
}

TEST_CASE("regroup: a request of an earlier registration is ignored")
{
    World world;
    world.add(1, "results", window(1));
    world.offer(1, true);
    world.offer(2, true);
    const auto decisions = decided([&](Decisions& to) {
        world.table.request(1, world.registrations[1] - 1, {100, 100, 100}, {}, world.now, to);
    });
    CHECK(decisions.sends.empty());
    CHECK(world.ask(1, {2, 1, 1}) == Got{{1, {2}}});
}

}  // namespace hive::event
