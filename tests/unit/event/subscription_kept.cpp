// What becomes of a plain receiver's events when its connection ends, and when it comes back.
#include "one_consumer.hpp"

#include <doctest/doctest.h>

namespace hive::event {

using namespace std::chrono_literals;

TEST_CASE("kept: live events are lost with their receiver, and no place is kept")
{
    OneConsumer one(window(1));
    one.offer(1);
    one.offer(2);
    CHECK_FALSE(one.lose(Fate::lost_killed));
    CHECK(one.ledger().of(Fate::lost_killed) == 2);
    CHECK(one.ledger().in_flight() == 0);
    CHECK(balanced(one.ledger()));
}

TEST_CASE("kept: none is kept for a receiver that does not come back, or that gets no bodies")
{
    OneConsumer leaver(window(1));
    leaver.offer(1, true);
    CHECK_FALSE(leaver.lose(Fate::lost_connection, false));
    CHECK(leaver.ledger().of(Fate::lost_connection) == 1);
    OneConsumer watcher(streaming(Delivery::notification));
    watcher.offer(1, true);
    CHECK_FALSE(watcher.lose(Fate::lost_connection));
    CHECK(watcher.ledger().in_flight() == 0);
}

TEST_CASE("kept: one is kept although everything is done, because the source waits for its receivers")
{
    OneConsumer one(window(1));
    one.offer(1, true);
    one.ask(2, 1);
    CHECK(one.lose(Fate::lost_connection));
    CHECK(one.subscription.awaited());
    CHECK(one.subscription.why() == Reason::place_kept);
    CHECK_FALSE(one.subscription.asks());
    CHECK(one.offer(2, true).empty());
    CHECK(one.resume(1) == Sequences{2});
}

TEST_CASE("kept: a receiver that was cut off goes on where it was, and gets nothing twice that it has")
{
    OneConsumer one(window(4));
    for (int i = 1; i <= 5; ++i)
        one.offer(i, true);
    one.ask({.asked = 5, .worked = 1, .done = 1});
    one.lose(Fate::lost_cut_off);
    one.told.clear();
    // It was sent five, took three of them and asks for four more: it gets the fourth and fifth again.
    CHECK(one.resume(3) == Sequences{4, 5});
    CHECK(one.behind == 3);
    REQUIRE(one.told.front());
    CHECK(one.told.front()->attempt == 2);
    CHECK(one.told.front()->turn == 4);
    CHECK(one.ledger().of(Fate::acknowledged) == 1);
    one.ask({.asked = 8, .worked = 5, .done = 5});
    CHECK(one.ledger().of(Fate::acknowledged) == 5);
    CHECK(one.ledger().in_flight() == 0);
    CHECK(one.offer(6, true) == Sequences{6});
    CHECK(balanced(one.ledger()));
}

TEST_CASE("kept: what a receiver still has to process counts against its window, whichever connection it came over")
{
    OneConsumer back(window(4));
    for (int i = 1; i <= 6; ++i)
        back.offer(i, true);
    back.lose(Fate::lost_cut_off);
    CHECK(back.resume(4, 3) == Sequences{5});  // one of four was processed
    CHECK(back.ask(6, 1) == Sequences{6});
    OneConsumer restarted(window(4));  // the sender was, and has been told of three events of its earlier run
    restarted.lose(Fate::lost_cut_off);
    for (int i = 1; i <= 6; ++i)
        restarted.offer(i, true);
    CHECK(restarted.resume(std::nullopt, 3) == Sequences{1});
    CHECK(restarted.ask(3) == Sequences{2, 3});
    OneConsumer full(window(4));
    full.lose(Fate::lost_cut_off);
    full.offer(1, true);
    CHECK(full.resume(std::nullopt, max_json_integer).empty());
    CHECK_FALSE(full.subscription.asks());
    CHECK(full.ask(1) == Sequences{1});
}

TEST_CASE("kept: of a stream, 64 lossless events less those that the receiver still has to process")
{
    OneConsumer one(streaming());
    one.lose(Fate::lost_cut_off);
    for (int i = 1; i <= 70; ++i)
        one.offer(i, true);
    CHECK(one.resume(std::nullopt, 62) == Sequences{1, 2});
    CHECK(one.ask(Progress{}).size() == 62);  // it has processed all of those, and none of the new ones
    CHECK(one.ask({.asked = 0, .worked = 6, .done = 0}).size() == 6);
}

TEST_CASE("kept: a receiver that began anew gets all it did not acknowledge, as the second attempt")
{
    OneConsumer one(window(3));
    for (int i = 1; i <= 4; ++i)
        one.offer(i, true);
    one.ask({.asked = 3, .worked = 2, .done = 1});
    one.lose(Fate::lost_killed);
    one.told.clear();
    CHECK(one.resume(std::nullopt) == Sequences{2, 3, 4});
    CHECK(one.behind == 1);
    REQUIRE(one.told.size() == 3);
    REQUIRE(one.told[0]);
    CHECK(*one.told[0] == Share{.of = "camera.image", .epoch = 1, .turn = 2, .attempt = 2});
    CHECK(one.told[1]->attempt == 2);
    CHECK_FALSE(one.told[2]);  // for the first time: it is told what all are told
    one.ask({.asked = 4, .worked = 4, .done = 4});
    CHECK(one.ledger().of(Fate::acknowledged) == 4);
    CHECK(balanced(one.ledger()));
}

TEST_CASE("kept: a receiver that claims to have taken more than it was sent, or less than it did, is not believed")
{
    OneConsumer more(window(2));
    more.offer(1, true);
    more.lose(Fate::lost_cut_off);
    CHECK(more.resume(1000).empty());
    CHECK(more.behind == 1);
    OneConsumer less(window(2));
    less.offer(1, true);
    less.offer(2, true);
    less.ask(3, 1);
    less.lose(Fate::lost_cut_off);
    CHECK(less.resume(0) == Sequences{2});
    CHECK(less.behind == 1);
}

TEST_CASE("kept: while it is kept, lossless events wait for it and live ones are not for it")
{
    OneConsumer one(window(2));
    one.offer(1);
    one.offer(2, true);
    one.lose(Fate::lost_cut_off);
    CHECK(one.offer(3).empty());
    CHECK(one.offer(4, true).empty());
    CHECK(one.ledger().total() == 3);
    CHECK(one.resume(std::nullopt) == Sequences{2, 4});
    CHECK(one.ledger().of(Fate::lost_cut_off) == 1);  // the live one was with it
    CHECK(balanced(one.ledger()));
}

TEST_CASE("kept: after 30 s it is not kept any longer, and what was in it is lost in the way its receiver was")
{
    OneConsumer one(window(1));
    one.offer(1, true);
    one.offer(2, true);
    one.lose(Fate::lost_cut_off);
    one.pass(30s - 1ns);
    CHECK(one.subscription.awaited());
    one.pass(1ns);
    CHECK_FALSE(one.subscription.awaited());
    CHECK(one.ledger().of(Fate::lost_cut_off) == 2);
    CHECK(one.ledger().in_flight() == 0);
    CHECK(balanced(one.ledger()));
}

TEST_CASE("kept: who was away for too long is told how many events that must arrive it has missed")
{
    OneConsumer one(window(1));
    one.offer(1, true);
    one.offer(2, true);
    CHECK(one.lose(Fate::lost_cut_off));
    CHECK(one.subscription.missed().count == 0);
    one.pass(30s);
    CHECK(one.subscription.missed().count == 2);
    one.offer(3, true);
    one.offer(4);
    CHECK(one.subscription.missed().count == 3);
    CHECK(one.ledger().total() == 3);
    SUBCASE("it comes back as a new process") { CHECK(one.resume(std::nullopt).empty()); }
    SUBCASE("it comes back with the one that it was sent")
    {
        one.resume(1);
        CHECK(one.subscription.missed().count == 2);
    }
    SUBCASE("nobody waits for it: what comes from now on it does not miss")
    {
        decided([&](Decisions& to) { one.subscription.cancel(to); });
        one.offer(5, true);
        CHECK(one.subscription.missed().count == 3);
    }
    SUBCASE("its source has begun anew: that is of its earlier run")
    {
        one.resume(std::nullopt);
        Event event = emission(1, true)->event();
        ++event.identity.epoch;
        one.offer(std::make_shared<const Emission>(event, true, std::nullopt));
        CHECK(one.subscription.missed().count == 0);
    }
    CHECK_FALSE(one.subscription.missing());
    CHECK(balanced(one.ledger()));
}

TEST_CASE("kept: an application that was cut off from a live source counts for 30 s what it does not get")
{
    for (const bool application : {true, false}) {
        OneConsumer one(window(1));
        one.subscription = Subscription({.application = application});
        one.resume(std::nullopt);
        one.offer(1);
        CHECK_FALSE(one.lose(Fate::lost_cut_off));
        one.offer(2);
        one.pass(30s - 1ns);
        one.offer(3);
        one.pass(1ns);
        one.offer(4);
        CHECK(one.ledger().of(Fate::lost_cut_off) == (application ? 3 : 1));
        CHECK(one.subscription.missed().count == 0);
        CHECK(balanced(one.ledger()));
    }
}

TEST_CASE("kept: an event that its receiver died of three times is given up and said so")
{
    OneConsumer one(window(2));
    one.offer(1, true);
    one.offer(2, true);
    for (int death = 1; death <= 3; ++death) {
        CHECK(one.failed.empty());
        one.lose(Fate::lost_killed);
        CHECK(one.resume(std::nullopt) == (death < 3 ? Sequences{1, 2} : Sequences{2}));
    }
    REQUIRE(one.failed.size() == 1);
    CHECK(sequence_of(one.failed.front()) == 1);
    REQUIRE(one.failed.front()->own());
    CHECK(one.failed.front()->own()->attempt == 3);
    CHECK(one.ledger().of(Fate::abandoned) == 1);
    CHECK(balanced(one.ledger()));
}

TEST_CASE("kept: what kills its receiver is given up also behind an event whose result is not acknowledged in time")
{
    OneConsumer one(window(2));
    one.offer(1, true);
    one.offer(2, true);
    for (int death = 1; death <= 3; ++death) {
        CHECK(one.failed.empty());
        one.ask({.asked = 2, .worked = 1, .done = 0});
        one.lose(Fate::lost_killed);
        CHECK(one.resume(std::nullopt) == (death < 3 ? Sequences{1, 2} : Sequences{1}));
    }
    REQUIRE(one.failed.size() == 1);
    CHECK(sequence_of(one.failed.front()) == 2);
    CHECK(balanced(one.ledger()));
}

TEST_CASE("kept: a connection that breaks is no failure of the work, however often it does")
{
    OneConsumer one(window(1));
    one.offer(1, true);
    for (int loss = 1; loss <= 20; ++loss) {
        one.lose(Fate::lost_connection);
        CHECK(one.resume(std::nullopt) == Sequences{1});
    }
    CHECK(one.failed.empty());
    CHECK(one.ledger().in_flight() == 1);
}

TEST_CASE("kept: a receiver that dies after it has worked did not die of the work")
{
    OneConsumer one(window(1));
    one.offer(1, true);
    one.ask({.asked = 1, .worked = 1, .done = 0});  // the result of the first is on its way
    for (int death = 1; death <= 5; ++death) {
        one.lose(Fate::lost_killed);
        CHECK(one.resume(std::nullopt) == Sequences{1});
        one.ask({.asked = 1, .worked = 1, .done = 0});
    }
    CHECK(one.failed.empty());
}

TEST_CASE("kept: who leaves has no use for what waits for it")
{
    OneConsumer one(window(1));
    one.offer(1, true);
    one.offer(2, true);
    one.lose(Fate::lost_left);
    CHECK(one.ledger().of(Fate::lost_left) == 2);
    CHECK(one.ledger().in_flight() == 0);
    CHECK_FALSE(one.subscription.backlogged());
}

}  // namespace hive::event
