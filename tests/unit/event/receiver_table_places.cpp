// Places and groups that the table keeps for receivers that were lost: who may take them up, and what lets them go.
#include "table_fixtures.hpp"

#include <doctest/doctest.h>

namespace hive::event {

using namespace std::chrono_literals;

TEST_CASE("kept place: a receiver of lossless events that comes back with its place goes on where it was")
{
    World world;
    world.add(1, "results", window(2));
    const auto place = world.welcome.place;
    world.offer(1, true);
    world.offer(2, true);
    world.lose(1, Fate::lost_cut_off);
    CHECK(world.table.demand().wanted);
    CHECK_FALSE(world.table.demand().asked);
    CHECK(world.table.why() == Reason::place_kept);
    CHECK(world.row("results").why == Reason::place_kept);
    CHECK_FALSE(world.row("results").connected);
    CHECK(world.offer(3, true).empty());
    CHECK(world.table.demand().backlogged);
    CHECK(world.table.unreceived() == 0);
    CHECK(world.add({.id = 2, .receiver = "results", .options = window(2), .place = place, .taken = 1})
          == Got{{2, {2, 3}}});
    CHECK(world.welcome.place == place);
    CHECK(world.welcome.taken == 1);
    world.ask(2, {5, 3, 3});
    CHECK(world.row("results").events.of(Fate::acknowledged) == 3);
    CHECK(world.row("results").events.in_flight() == 0);
    CHECK(world.standing(place) == ReceiverId{2});
}

TEST_CASE("kept place: a restarted receiver takes up the place of its name if nobody else has that name")
{
    World world;
    world.add(1, "results", window(2));
    const auto place = world.welcome.place;
    world.offer(1, true);
    world.lose(1, Fate::lost_killed);
    CHECK(world.add({.id = 2, .receiver = "results", .options = window(2), .unique = false}).empty());
    CHECK(world.welcome.place != place);
    CHECK(world.table.why() == Reason::place_kept);
    CHECK(world.add({.id = 3, .receiver = "results", .options = window(2), .unique = true}) == Got{{3, {1}}});
    CHECK(world.welcome.place == place);
    REQUIRE(world.last_share);
    CHECK(world.last_share->attempt == 2);
}

TEST_CASE("kept place: nobody takes up the place of another")
{
    World world;
    world.add(1, "results", window(2));
    const auto place = world.welcome.place;
    world.offer(1, true);
    world.lose(1, Fate::lost_cut_off);
    CHECK(world.add({.id = 2, .receiver = "thief", .options = window(2), .place = place, .taken = 0}).empty());
    CHECK(world.welcome.place != place);
    CHECK(world.welcome.taken == 0);
    CHECK_FALSE(world.standing(place));
}

TEST_CASE("kept place: a receiver that is back before its end was noticed goes on at its place")
{
    World world;
    world.add(1, "results", window(2));
    const auto place = world.welcome.place;
    world.offer(1, true);
    CHECK(world.add({.id = 2, .receiver = "results", .options = window(2), .place = place, .taken = 0})
          == Got{{2, {1}}});
    CHECK(world.standing(place) == ReceiverId{2});
    world.lose(1, Fate::lost_cut_off);
    CHECK(world.row("results").connected);
    CHECK(world.offer(2, true) == Got{{2, {2}}});
}

TEST_CASE("kept place: a receiver whose confirmation was lost goes on where it was registered")
{
    World world;
    world.add({.id = 1, .receiver = "results", .options = window(2), .tried = 7});
    const auto place = world.welcome.place;
    world.offer(1, true);
    Newcomer again{.id = 2, .receiver = "results", .options = window(2), .tried = 7};
    SUBCASE("and the end of that connection is not noticed yet")
    {
        CHECK(world.add(again) == Got{{2, {1}}});
        CHECK(world.welcome.ends == ReceiverId{1});
        world.lose(1, Fate::lost_connection);
    }
    SUBCASE("and that connection has ended")
    {
        world.lose(1, Fate::lost_connection);
        CHECK(world.add(again) == Got{{2, {1}}});
    }
    CHECK(world.welcome.place == place);
    CHECK(world.table.why() != Reason::place_kept);
    world.add({.id = 3, .receiver = "results", .options = window(2), .tried = 8});  // another receiver of its name
    CHECK(world.welcome.place != place);
    world.add({.id = 4, .receiver = "results", .options = window(2), .tried = 7, .run = 1});  // and one of another run
    CHECK(world.welcome.place != place);
}

TEST_CASE("displaced: a drone that registers again is received once, before its old connection is seen to be dead")
{
    auto watching = window(4);
    watching.delivery = Delivery::notification;
    for (const auto& options : {watching, streaming(Delivery::data), sharing()}) {
        World world;
        world.add({.id = 1, .receiver = "face.image", .options = options, .unique = true});
        world.offer(1);
        const auto again = world.add({.id = 2, .receiver = "face.image", .options = options, .unique = true});
        CHECK(again == (options.group.empty() ? Got{} : Got{{2, {1}}}));
        world.ask(2, {8, 1, 1});
        CHECK(world.row("face.image").connected);
        CHECK(world.offer(2) == Got{{2, {2}}});
        world.lose(1, Fate::lost_cut_off);
        CHECK(world.row("face.image").connected);
        CHECK(world.row("face.image").events.total() <= (options.group.empty() ? 2 : 3));
        world.leave(2);
        CHECK_FALSE(world.table.demand().wanted);
    }
}

TEST_CASE("displaced: a restarted drone gets again what its old connection had in hand, and its place is its own")
{
    World world;
    world.add({.id = 1, .receiver = "face.image", .options = window(2), .unique = true});
    world.offer(1, true);
    world.offer(2, true);
    CHECK(world.add({.id = 2, .receiver = "face.image", .options = window(2), .unique = true}) == Got{{2, {1, 2}}});
    world.lose(1, Fate::lost_cut_off);
    CHECK(world.table.why() == Reason::not_asked);
    world.ask(2, {4, 2, 2});
    CHECK(world.row("face.image").events.of(Fate::acknowledged) == 2);
    CHECK(world.row("face.image").events.in_flight() == 0);
    CHECK(world.table.demand().asked);
}

TEST_CASE("displaced: another drone of the same name has a place, a row and counts of its own, and takes up none")
{
    World world;
    world.add({.id = 1, .receiver = "face.image", .options = window(2), .run = 10, .unique = true});
    CHECK(world.offer(1, true) == Got{{1, {1}}});
    CHECK(world.add({.id = 2, .receiver = "face.image", .options = window(2), .run = 20, .unique = true}).empty());
    CHECK_FALSE(world.welcome.ends);
    CHECK(world.offer(2, true) == Got{{1, {2}}, {2, {2}}});
    REQUIRE(world.rows().size() == 2);
    CHECK(world.rows()[0].events.total() + world.rows()[1].events.total() == 3);
    world.lose(1, Fate::lost_killed);
    CHECK(world.add({.id = 3, .receiver = "face.image", .options = window(2), .run = 30, .unique = true})
          == Got{{3, {1, 2}}});
    CHECK(world.offer(3, true) == Got{{2, {3}}});
}

TEST_CASE("kept place: of more than 256, the one that was lost first is waited for no longer")
{
    World world;
    for (ReceiverId id = 1; id <= 300; ++id) {
        world.add(
            {.id = id, .receiver = "face-" + std::to_string(id) + ".image", .options = window(1), .unique = true});
        world.lose(id, Fate::lost_cut_off);
    }
    world.offer(1, true);
    world.add({.id = 301, .receiver = "face-1.image", .options = window(1), .unique = true});
    CHECK(world.row("face-1.image").events.in_flight() == 0);
    CHECK(world.add({.id = 302, .receiver = "face-300.image", .options = window(1), .unique = true})
          == Got{{302, {1}}});
    CHECK(world.forget("face-45") == 1);
    CHECK(world.forget("face-44") == 0);
}

TEST_CASE("kept place: nobody pushes another from its place, nor by merely watching")
{
    World world;
    world.add(1, "results", window(2));
    const auto place = world.welcome.place;
    world.add({.id = 2, .receiver = "thief", .options = window(2), .place = place, .taken = 0});
    auto watching = window(2);
    watching.delivery = Delivery::notification;
    world.add({.id = 3, .receiver = "results", .options = watching, .place = place, .taken = 0});
    CHECK(world.standing(place) == ReceiverId{1});
    CHECK(world.table.why() == Reason::none);
    CHECK(world.offer(1, true).at(1) == Sequences{1});
    world.leave(1);
    world.leave(2);
    CHECK_FALSE(world.table.demand().wanted);
}

TEST_CASE("kept place: also for a receiver that is lost before the first event, until that shows what the output is")
{
    World lossless;
    lossless.add({.id = 1, .receiver = "face.image", .options = window(1), .unique = true});
    lossless.add(2, "other", window(1));
    lossless.lose(1, Fate::lost_killed);
    CHECK(lossless.table.why() == Reason::place_kept);
    CHECK(lossless.offer(1, true) == Got{{2, {1}}});
    CHECK(lossless.add({.id = 3, .receiver = "face.image", .options = window(1), .unique = true}) == Got{{3, {1}}});
    World live;
    live.add({.id = 1, .receiver = "face.image", .options = window(1), .unique = true});
    live.lose(1, Fate::lost_killed);
    CHECK(live.table.demand().wanted);
    CHECK(live.offer(1).empty());
    CHECK_FALSE(live.table.demand().wanted);
    CHECK(live.table.unreceived() == 1);
}

TEST_CASE("kept place: none for live events, for a receiver that will not return, or without that defence")
{
    World live;
    live.add(1, "view", window(1));
    live.offer(1);
    live.lose(1, Fate::lost_cut_off);
    CHECK_FALSE(live.table.demand().wanted);
    World leaving;
    leaving.add(1, "results", window(1));
    leaving.offer(1, true);
    leaving.lose(1, Fate::lost_connection, false);
    CHECK_FALSE(leaving.table.demand().wanted);
    CHECK(leaving.row("results").events.of(Fate::lost_connection) == 1);
    World without({.leases = true, .places = false});
    without.add(1, "results", window(1));
    without.offer(1, true);
    without.lose(1, Fate::lost_cut_off);
    CHECK_FALSE(without.table.demand().wanted);
}

TEST_CASE("kept place: after 30 s it is let go, and the source goes on without it")
{
    World world;
    world.add(1, "results", window(1));
    world.add(2, "other", window(1));
    world.offer(1, true);
    world.ask(2, {2, 1, 1});
    world.lose(1, Fate::lost_cut_off);
    CHECK(world.table.timed());
    CHECK_FALSE(world.table.demand().asked);
    world.pass(30s - 1ns);
    CHECK_FALSE(world.table.demand().asked);
    world.pass(1ns);
    world.pass(20ms);  // what it has missed by now is written down with one more tick
    CHECK_FALSE(world.table.timed());
    CHECK(world.table.demand().asked);
    CHECK(world.row("results").events.of(Fate::lost_cut_off) == 1);
    CHECK(world.row("results").events.in_flight() == 0);
    CHECK(world.table.missed(2) == 0);
    SUBCASE("what it is not sent then it misses")
    {
        world.offer(2, true);
        world.add({.id = 3, .receiver = "results", .options = window(1), .unique = true});
        CHECK(world.table.missed(3) == 2);
    }
    SUBCASE("it misses nothing more once it is forgotten")
    {
        CHECK(world.forget("results") == 0);
        world.offer(2, true);
        world.add({.id = 3, .receiver = "results", .options = window(1), .unique = true});
        CHECK(world.table.missed(3) == 1);
    }
    SUBCASE("nor what waits at the output for whoever comes first")
    {
        world.leave(2);
        world.offer(2, true, true);
        CHECK(world.add({.id = 3, .receiver = "results", .options = window(1), .unique = true}) == Got{{3, {2}}});
        CHECK(world.table.missed(3) == 1);
    }
}

TEST_CASE("kept place: forgetting a drone lets go all places of its inputs, and nobody else's")
{
    World world;
    world.add(1, "face.image", window(1));
    world.add(2, "face.marks", window(1));
    world.add(3, "face-2.image", window(1));
    world.offer(1, true);
    for (const ReceiverId id : {1, 2, 3})
        world.lose(id, Fate::lost_cut_off);
    CHECK(world.forget("face") == 2);
    CHECK(world.table.demand().wanted);
    CHECK(world.row("face.image").events.of(Fate::lost_left) == 1);
    CHECK(world.forget("face-2") == 1);
    CHECK_FALSE(world.table.demand().wanted);
    CHECK(world.forget("face-2") == 0);
}

TEST_CASE("kept place: a drone whose name begins like another's is another drone")
{
    World world;
    world.add(1, "cam.image", window(1));
    world.add(2, "cam.1.image", window(1));
    world.offer(1, true);
    CHECK(world.table.registered("cam") == std::vector<ReceiverId>{1});
    CHECK(world.table.registered("cam.1") == std::vector<ReceiverId>{2});
    for (const ReceiverId id : {1, 2})
        world.lose(id, Fate::lost_cut_off);
    CHECK(world.forget("cam") == 1);
    CHECK(world.row("cam.1.image").events.in_flight() == 1);
    CHECK(world.forget("cam.1") == 1);
}

TEST_CASE("kept place: its account stays when another receiver of the same name leaves")
{
    World world;
    world.add(1, "results", window(1));
    const auto place = world.welcome.place;
    world.offer(1, true);
    world.lose(1, Fate::lost_cut_off);
    world.add(2, "results", window(1));
    world.leave(2);
    CHECK(world.row("results").events.in_flight() == 1);
    world.add({.id = 3, .receiver = "results", .options = window(1), .place = place, .taken = 1});
    world.ask(3, {2, 1, 1});
    CHECK(world.row("results").events.of(Fate::acknowledged) == 1);
    CHECK(world.row("results").events.in_flight() == 0);
}

TEST_CASE("kept place: its account is not forgotten before it, however many receivers are lost")
{
    World world;
    world.add(1, "results", window(1));
    const auto place = world.welcome.place;
    world.offer(1, true);
    world.lose(1, Fate::lost_cut_off);
    auto watching = window(1);
    watching.delivery = Delivery::notification;
    for (ReceiverId i = 2; i <= 2 + 2 * ReceiverTable::max_gone; ++i) {
        world.add(i, "watcher-" + std::to_string(i), watching);
        world.lose(i, Fate::lost_connection);
    }
    CHECK(world.rows().size() <= ReceiverTable::max_gone + 1);
    CHECK(world.row("results").events.in_flight() == 1);
    CHECK(world.add({.id = 999, .receiver = "results", .options = window(1), .place = place, .taken = 1}).empty());
    world.ask(999, {2, 1, 1});
    CHECK(world.row("results").events.of(Fate::acknowledged) == 1);
}

TEST_CASE("awaited group: its account stays as long as the group does, however many receivers are lost")
{
    World world;
    world.add(1, "face-1", sharing());
    auto watching = window(1);
    watching.delivery = Delivery::notification;
    for (ReceiverId i = 2; i <= 2 + 2 * ReceiverTable::max_gone; ++i) {
        world.add(i, "watcher-" + std::to_string(i), watching);
        world.lose(i, Fate::lost_connection);
    }
    CHECK(world.has_row("group workers"));
    CHECK(world.has_row("face-1"));
    world.offer(1, true);
    world.ask(1, {2, 1, 1});
    CHECK(world.row("group workers").events.of(Fate::acknowledged) == 1);
}

TEST_CASE("awaited group: of more than 256, the one that was lost first is waited for no longer")
{
    World world;
    auto options = sharing();
    for (ReceiverId id = 1; id <= 257; ++id) {
        options.group = "group-" + std::to_string(id);
        world.add(id, "face-" + std::to_string(id) + ".image", options);
        world.offer(static_cast<std::int64_t>(id), true);
        world.lose(id, Fate::lost_killed);
    }
    CHECK(world.table.demand().wanted);
    CHECK(world.add(1, "face-1.image", sharing(1)).empty());
    CHECK(world.leave(1).empty());
    for (int id = 2; id <= 257; ++id)
        CHECK(world.forget("face-" + std::to_string(id)) == 1);
    CHECK_FALSE(world.table.demand().wanted);
}

TEST_CASE("awaited group: a member that is away is forgotten, and counted, although others are there")
{
    World world;
    world.add(1, "face-1.image", sharing());
    world.add(2, "face-2.image", sharing());
    world.offer(1, true);
    world.lose(1, Fate::lost_cut_off);
    CHECK(world.forget("face-1") == 1);
    world.pass(20ms);
    CHECK(world.forget("face-1") == 0);
}

TEST_CASE("awaited group: forgetting one of the drones that were lost lets it go, and what waited is given up")
{
    World world;
    world.add(1, "face-1.image", sharing());
    world.offer(1, true);
    world.offer(2, true);
    world.lose(1, Fate::lost_killed);
    CHECK(world.table.demand().wanted);
    CHECK(world.table.why() == Reason::group_awaited);
    CHECK(world.forget("face-2") == 0);
    CHECK(world.forget("face-1") == 1);
    CHECK_FALSE(world.table.demand().wanted);
    CHECK(world.failed == Sequences{2});  // face-1 may have answered event 1
}

TEST_CASE("awaited group: while a lost member may return, the group is awaited when the last present member leaves")
{
    World world;
    world.add(1, "face-1.image", sharing());
    world.add(2, "face-2.image", sharing());
    world.add(9, "view", window(64));
    world.offer(1, true);
    world.lose(1, Fate::lost_killed);
    SUBCASE("it has all events that come meanwhile")
    {
        world.leave(2);
        CHECK(world.table.why() == Reason::group_awaited);
        CHECK(world.offer(2, true) == Got{{9, {2}}});
        CHECK(world.failed.empty());
        CHECK(world.add(3, "face-1.image", sharing(4)) == Got{{3, {1, 2}}});
    }
    SUBCASE("for 30 s at most")
    {
        world.leave(2);
        world.offer(2, true);
        world.pass(31s);
        CHECK(world.failed == Sequences{2});  // face-1 may have answered event 1
        CHECK_FALSE(world.table.timed());
        world.add(3, "face-3.image", sharing());
        world.leave(3);
        CHECK(world.table.why() != Reason::group_awaited);
    }
    SUBCASE("forgetting one of two that were lost lets go only that one")
    {
        world.add(3, "face-3.image", sharing());
        world.lose(3, Fate::lost_killed);
        world.leave(2);
        CHECK(world.forget("face-1") == 1);
        CHECK(world.table.why() == Reason::group_awaited);
        CHECK(world.forget("face-3") == 1);
        CHECK(world.table.why() != Reason::group_awaited);
    }
    SUBCASE("not for one that was forgotten before")
    {
        world.forget("face-1");
        world.leave(2);
        CHECK(world.table.why() != Reason::group_awaited);
    }
    SUBCASE("not for one without which the others have worked for 30 s")
    {
        world.pass(30s);
        world.leave(2);
        CHECK(world.table.why() != Reason::group_awaited);
    }
    SUBCASE("if the whole group was lost, the 30 s begin when its first member is back")
    {
        world.lose(2, Fate::lost_killed);
        world.pass(1h);
        world.add(3, "face-2.image", sharing());
        world.pass(29s);
        world.leave(3);
        CHECK(world.table.why() == Reason::group_awaited);
        world.pass(2s);
        CHECK(world.table.why() != Reason::group_awaited);
    }
}

TEST_CASE("awaited group: work of a source on demand holds the source up until a member is there again")
{
    World world;
    world.add(1, "face-1", sharing());
    world.offer(1, true);
    world.lose(1, Fate::lost_killed);
    CHECK_FALSE(world.table.demand().asked);
    CHECK(world.add(2, "face-1", sharing()) == Got{{2, {1}}});
    REQUIRE(world.welcome.group);
    CHECK(*world.welcome.group == Share{.of = "camera.image#workers", .epoch = 1, .turn = 1, .closed = 0});
    world.ask(2, {2, 1, 1});
    CHECK(world.table.demand().asked);
}

TEST_CASE("awaited group: a live source that somebody else receives keeps nothing new for a group without members")
{
    World world;
    world.add(1, "face-1", sharing());
    world.add(9, "view", window(64));
    world.lose(1, Fate::lost_killed);
    CHECK(world.offer(1) == Got{{9, {1}}});
    CHECK(world.table.demand().asked);
    CHECK(world.add(7, "face-1", sharing()).empty());
}

TEST_CASE("awaited group: of those without members only the last are remembered, what waited in others is given up")
{
    World world;
    const auto member_of = [&](std::size_t number) {
        auto options = sharing();
        options.group = "group-" + std::to_string(number);
        return options;
    };
    for (std::size_t i = 0; i <= ReceiverTable::max_empty_groups; ++i) {
        world.add(i, "face", member_of(i));
        world.offer(static_cast<std::int64_t>(i));
        CHECK(world.failed.empty());
        world.lose(i, Fate::lost_killed);
    }
    CHECK(world.failed == Sequences{0});
    CHECK_FALSE(world.has_row("group group-0"));
    CHECK(world.has_row("group group-1"));
    CHECK(world.add(100, "face", member_of(0)).empty());
    CHECK(world.add(101, "face", member_of(1)) == Got{{101, {1}}});
    CHECK(world.offer(50) == Got{{100, {50}}});
    CHECK(world.last_share->turn > 1);  // a receiver would take turn 1 for the one that was given up
}

TEST_CASE("guest: it gets what there is, and neither lets a source begin nor holds it up")
{
    World world;
    world.add({.id = 1, .receiver = "results (viewer)", .options = window(1), .guest = true});
    CHECK(world.table.demand().wanted);  // bodies are made for it
    CHECK_FALSE(world.table.awaited());
    CHECK_FALSE(world.table.demand().asked);
    CHECK(world.table.why() == Reason::watched);
    CHECK(world.offer(1, true, true) == Got{{1, {1}}});
    CHECK(world.table.unreceived() == 0);  // it is held for who comes to work
    CHECK(world.add({.id = 2, .receiver = "results", .options = window(1)}) == Got{{2, {1}}});
    CHECK(world.table.awaited());
    CHECK(world.ask(2, {2, 1, 1}).empty());
    CHECK(world.table.demand().asked);  // although the guest never asked again
    CHECK(world.offer(2, true) == Got{{2, {2}}});
    CHECK_FALSE(world.table.demand().backlogged);
    CHECK(world.ask(2, {3, 2, 2}).empty());
    CHECK(world.offer(3, true) == Got{{2, {3}}});
    CHECK(world.ask(1, {2, 1, 1}) == Got{{1, {3}}});  // the newest
    CHECK(world.row("results (viewer)").events.of(Fate::skipped) == 1);
}

TEST_CASE("guest: no place is kept for it, and it takes nobody's")
{
    World world;
    world.add(1, "results", window(2));
    const auto place = world.welcome.place;
    world.offer(1, true);
    world.lose(1, Fate::lost_cut_off);
    CHECK(world.add({.id = 2, .receiver = "results", .options = window(2), .place = place, .taken = 0, .guest = true})
              .empty());
    CHECK(world.welcome.place != place);
    CHECK(world.table.why() == Reason::place_kept);
    CHECK(world.offer(2, true) == Got{{2, {2}}});
    world.lose(2, Fate::lost_cut_off);
    CHECK(world.add({.id = 3, .receiver = "results", .options = window(2), .place = place, .taken = 1})
          == Got{{3, {2}}});
}

TEST_CASE("receiver table: who is back at its own place leaves another one of its name, which expires as any other")
{
    World world;
    world.add({.id = 1, .receiver = "results", .options = window(1)});
    const auto place = world.welcome.place;
    world.offer(1, true);
    world.lose(1, Fate::lost_connection);
    world.add({.id = 2, .receiver = "results", .options = window(1)});
    world.offer(2, true);
    CHECK(world.add({.id = 3, .receiver = "results", .options = window(1), .place = place, .unique = true})
          == Got{{3, {1}}});
    world.ask(3, {2, 1, 1});
    world.ask(3, {3, 2, 2});
    CHECK_FALSE(world.table.demand().asked);  // for the other place
    world.pass(Subscription::kept_for);
    CHECK(world.table.demand().asked);
    for (const auto& row : world.rows())
        CHECK(row.events.in_flight() == 0);
}

TEST_CASE("receiver table: a member has a place for 30 s, like a plain receiver")
{
    World world;
    world.add(1, "face", sharing(2));
    const auto place = world.welcome.place;
    CHECK(place != 0);
    world.offer(1, true);
    world.lose(1, Fate::lost_connection);
    bool same = true;
    SUBCASE("in time") {}
    SUBCASE("too late")
    {
        same = false;
        world.pass(31s);
    }
    const auto got = world.add({.id = 2, .receiver = "face", .options = sharing(2), .place = place, .taken = 1});
    CHECK(got.empty() == same);
    CHECK((world.welcome.taken == 1) == same);
    CHECK(world.row("face").events.total() == 2);
    CHECK(world.row("face").events.in_flight() == 1);
    CHECK(world.row("group workers").events.in_flight() == 1);
}

}  // namespace hive::event
