// All receivers of an output together: what is wanted and asked for, accounts, events that are held for the first.
#include "table_fixtures.hpp"

#include <hive/event/ticket.hpp>

#include <doctest/doctest.h>

namespace hive::event {

using namespace std::chrono_literals;

TEST_CASE("receiver table: a notification receiver makes no body wanted")
{
    World world;
    CHECK_FALSE(world.table.demand().wanted);
    world.add(1, "top", streaming(Delivery::notification));
    const auto decisions = decided([&](Decisions& to) { world.table.offer(emission(1), false, start, to); });
    CHECK_FALSE(world.table.demand().wanted);
    REQUIRE(decisions.sends.size() == 1);
    CHECK(decisions.sends[0].delivery == Delivery::notification);
}

TEST_CASE("receiver table: demand is there when every receiver of bodies has asked")
{
    World world;
    CHECK_FALSE(world.table.demand().asked);
    CHECK(world.table.why() == Reason::no_receiver);
    world.add(1, "fast", window(1));
    CHECK(world.table.demand().asked);
    world.add(2, "slow", window(1));
    world.add(3, "top", streaming(Delivery::notification));
    world.offer(1, true);
    CHECK_FALSE(world.table.demand().asked);
    world.ask(1, {2, 1, 1});
    CHECK_FALSE(world.table.demand().asked);
    CHECK(world.table.why() == Reason::not_asked);
    world.ask(2, {2, 1, 1});
    CHECK(world.table.demand().asked);
    CHECK(world.table.why() == Reason::none);
}

TEST_CASE("receiver table: a lossless event without any receiver waits for the first one")
{
    World world;
    CHECK(world.offer(1, true, true).empty());
    CHECK(world.offer(2, true, true).empty());
    CHECK(world.table.demand().backlogged);
    CHECK(world.table.why() == Reason::held);
    world.add(5, "top", streaming(Delivery::notification));
    CHECK(world.table.demand().backlogged);
    CHECK(world.add(1, "results", window(2)) == Got{{1, {1, 2}}});
    CHECK_FALSE(world.table.demand().backlogged);
    CHECK(world.add(2, "late", window(2)).empty());
}

TEST_CASE("receiver table: what is held for the first receiver may be a group's, too")
{
    World world;
    world.offer(1, true, true);
    CHECK(world.add(1, "face", sharing()) == Got{{1, {1}}});
    CHECK(world.last_share->turn == 1);
}

TEST_CASE("receiver table: what is held is let go when another output is received, and counts as unreceived")
{
    World world;
    world.offer(1, true, true);
    world.offer(2, true, true);
    CHECK(world.table.unreceived() == 0);
    world.table.release_held();
    CHECK_FALSE(world.table.demand().backlogged);
    CHECK(world.table.unreceived() == 2);
    CHECK(world.add(1, "late", window(2)).empty());
}

TEST_CASE("receiver table: an event that nobody receives is counted, and a live one is not held")
{
    World world;
    CHECK(world.offer(1, false, true).empty());
    CHECK(world.table.unreceived() == 1);
    CHECK_FALSE(world.table.demand().backlogged);
    world.add(1, "face", window(1));
    world.offer(2);
    CHECK(world.table.unreceived() == 1);
}

TEST_CASE("receiver table: first_frame begins with the newest event that there is")
{
    World world;
    world.offer(1);
    world.offer(2);
    auto options = window(1);
    CHECK(world.add(1, "late", options).empty());
    options.first_frame = true;
    CHECK(world.add(2, "early", options) == Got{{2, {2}}});
}

TEST_CASE("receiver table: an event whose body nobody wanted goes to notifications only")
{
    World world;
    world.add(1, "face", window(1));
    world.add(2, "top", streaming(Delivery::notification));
    const auto bodiless = std::make_shared<const Emission>(emission(1)->event(), false);
    CHECK(world.offer(bodiless) == Got{{2, {1}}});
    auto late = window(1);
    late.first_frame = true;
    CHECK(world.add(3, "snap", late).empty());
}

TEST_CASE("receiver table: an event is acknowledged when the receivers of bodies are done, whoever keeps or watches "
          "the event")
{
    World world;
    world.add(1, "collector", window(2));
    auto watching = window(1);
    watching.delivery = Delivery::notification;
    world.add(2, "watcher that asks no more", watching);
    world.offer(1);
    bool acknowledged = false;
    Event event = emission(2, true)->event();
    event.ticket = {{new Acknowledgement,
                     [&](Acknowledgement* owed) {
                         delete owed;
                         acknowledged = true;
                     }},
                    false};
    CHECK(world.offer(std::make_shared<const Emission>(std::exchange(event, {}))) == Got{{1, {2}}});
    CHECK_FALSE(acknowledged);
    world.ask(1, {3, 2, 1});  // the first is done, the second was worked on
    CHECK_FALSE(acknowledged);
    world.ask(1, {4, 2, 2});
    CHECK(acknowledged);
}

TEST_CASE("receiver table: a removed receiver gets nothing, and nobody else notices")
{
    World world;
    world.add(1, "a", streaming());
    world.add(2, "b", streaming());
    world.leave(1);
    CHECK(world.offer(1) == Got{{2, {1}}});
    CHECK(world.ask(1, {5, 5, 5}).empty());
    CHECK(world.rows().size() == 1);
}

TEST_CASE("receiver table: the account of a drone outlives its registrations, that of an application does not")
{
    World world;
    const auto face = [](ReceiverId id) {
        return Newcomer{.id = id, .receiver = "face.image", .options = window(1), .unique = true};
    };
    world.add(face(1));
    world.offer(1);
    world.lose(1, Fate::lost_killed);
    const auto lost = world.row("face.image");
    CHECK_FALSE(lost.connected);
    CHECK(lost.events.of(Fate::lost_killed) == 1);
    world.add(face(2));
    world.offer(2);
    world.ask(2, {2, 1, 1});
    const auto back = world.row("face.image");
    CHECK(back.connected);
    CHECK(back.registration > lost.registration);
    CHECK(back.events.total() == 2);
    CHECK(back.events.of(Fate::acknowledged) == 1);
    world.leave(2);
    CHECK_FALSE(world.row("face.image").connected);
    CHECK(world.row("face.image").events.total() == 2);
    world.add(3, "app-1", window(1));
    world.leave(3);
    CHECK_FALSE(world.has_row("app-1"));  // the next one of its name is somebody else
}

TEST_CASE("receiver table: two applications of one name have an account each")
{
    World world;
    world.add(1, "app-1", window(1));
    world.add(2, "app-1", window(1));
    world.offer(1, true);
    world.ask(1, {2, 1, 1});
    const auto rows = world.rows();
    REQUIRE(rows.size() == 2);
    for (const auto& row : rows) {
        CHECK(row.events.total() == 1);
        CHECK(row.events.of(Fate::acknowledged) == (row.registration == world.registrations[1] ? 1 : 0));
    }
    world.lose(1, Fate::lost_connection);
    world.pass(31s);
    world.add(3, "app-1", window(1));
    CHECK(world.rows().size() == 3);  // nobody knows whether that is the first one
}

TEST_CASE("receiver table: the accounts of receivers that were lost are bounded, the oldest goes first")
{
    World world;
    const auto most = ReceiverTable::max_gone;
    for (std::size_t i = 1; i <= most + 5; ++i) {
        world.add(i, "face-" + std::to_string(i), window(1));
        world.offer(static_cast<std::int64_t>(i));
        world.lose(i, Fate::lost_connection);
    }
    CHECK(world.rows().size() == most);
    CHECK(world.has_row("face-6"));
    CHECK_FALSE(world.has_row("face-5"));
}

TEST_CASE("receiver table: a group has an account of its own beside those of its members")
{
    World world;
    world.add(1, "face-1", sharing());
    world.add(2, "face-2", sharing());
    world.offer(1, true);
    world.offer(2, true);
    world.ask(1, {2, 1, 1});
    world.lose(2, Fate::lost_killed);
    const auto group = world.row("group workers");
    CHECK(group.group);
    CHECK(group.connected);
    CHECK(group.events.total() == 2);
    CHECK(group.events.of(Fate::acknowledged) == 1);
    CHECK(group.events.in_flight() == 1);  // given to the first again
    CHECK(world.row("face-1").events.total() == 2);
    CHECK(world.row("face-2").events.of(Fate::passed_on) == 1);
}

}  // namespace hive::event
