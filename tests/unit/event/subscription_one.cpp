// What a plain receiver gets when: credit, windows, streams, what is skipped and what is not.
#include "one_consumer.hpp"

#include <doctest/doctest.h>

namespace hive::event {

TEST_CASE("one consumer: a synchronized receiver gets one event and then nothing until it asks")
{
    OneConsumer one(window(1));
    CHECK(one.offer(1) == Sequences{1});
    CHECK(one.offer(2).empty());
    CHECK(one.ask(2) == Sequences{2});
}

TEST_CASE("one consumer: what waits for a request is the newest")
{
    OneConsumer one(window(1));
    one.offer(1);
    for (int i = 2; i <= 9; ++i)
        CHECK(one.offer(i).empty());
    CHECK(one.ask(2) == Sequences{9});
    CHECK(one.ledger().of(Fate::skipped) == 7);
    CHECK(one.ledger().in_flight() == 2);
    CHECK(balanced(one.ledger()));
}

TEST_CASE("one consumer: the same event is never sent twice to one receiver")
{
    OneConsumer one(window(1));
    one.offer(1);
    CHECK(one.ask(2).empty());
    CHECK(one.ask(3).empty());
    CHECK(one.offer(2) == Sequences{2});
}

TEST_CASE("one consumer: a window of three lets three go before the first answer")
{
    OneConsumer one(window(3));
    CHECK(one.offer(1) == Sequences{1});
    CHECK(one.offer(2) == Sequences{2});
    CHECK(one.offer(3) == Sequences{3});
    CHECK(one.offer(4).empty());
    CHECK(one.ask(4) == Sequences{4});
}

TEST_CASE("one consumer: a repeated or late request neither wedges nor sends twice")
{
    OneConsumer one(window(1));
    one.offer(1);
    one.ask(2);
    CHECK(one.ask(2).empty());
    CHECK(one.ask(1).empty());
    CHECK(one.offer(2) == Sequences{2});
    CHECK(one.offer(3).empty());
    CHECK(one.ask(2).empty());
    CHECK(one.ask(3) == Sequences{3});
}

TEST_CASE("one consumer: asking for a billion gives no more than the window")
{
    OneConsumer one(window(2));
    one.offer(1);
    one.ask(1'000'000'000);
    CHECK(one.offer(2) == Sequences{2});
    CHECK(one.offer(3) == Sequences{3});
    CHECK(one.offer(4).empty());
}

TEST_CASE("one consumer: who claims to have done more than it was sent has done what it was sent")
{
    OneConsumer one(window(2));
    one.offer(1);
    one.ask(1'000'000'000, 1'000'000'000);
    CHECK(one.ledger().of(Fate::acknowledged) == 1);
    one.offer(2);
    CHECK(one.ledger().in_flight() == 1);
    CHECK(balanced(one.ledger()));
}

TEST_CASE("one consumer: an event is acknowledged when the receiver has done it, not when it was written")
{
    OneConsumer one(streaming());
    for (int i = 1; i <= 100; ++i)
        CHECK(one.offer(i) == Sequences{i});
    CHECK(one.ledger().of(Fate::acknowledged) == 0);
    CHECK(one.ledger().in_flight() == 100);
    one.ask(0, 60);
    CHECK(one.ledger().of(Fate::acknowledged) == 60);
    CHECK(one.ledger().in_flight() == 40);
    CHECK(balanced(one.ledger()));
}

TEST_CASE("one consumer: a stream whose transport stands still keeps the newest and counts the rest")
{
    OneConsumer one(streaming());
    one.stalled = true;
    const std::size_t image = Subscription::max_queued_bytes;
    for (int i = 1; i <= 20; ++i)
        one.offer(emission(i, false, image));
    CHECK(one.ledger().total() == 20);
    CHECK(one.ledger().in_flight() == 2);  // one with the transport, the newest behind it
    CHECK(one.ledger().of(Fate::dropped) == 18);
    CHECK(one.subscription.why() == Reason::lane_full);
    CHECK(balanced(one.ledger()));
    CHECK(one.written(image) == Sequences{20});
}

TEST_CASE("one consumer: live events that wait behind a lossless one are dropped like others")
{
    OneConsumer one(streaming());
    int sent = 1;
    while (!one.offer(sent, true).empty())  // until the receiver has to work on some
        REQUIRE(++sent < 1000);
    for (int i = 1; i <= 5000; ++i)
        one.offer(sent + i);
    CHECK(one.subscription.waiting() <= static_cast<std::int64_t>(Subscription::max_queued_events));
    CHECK(one.ledger().of(Fate::dropped) >= 5000 - static_cast<std::int64_t>(Subscription::max_queued_events));
    CHECK(balanced(one.ledger()));
}

TEST_CASE("one consumer: what waited behind an event that was dropped goes at once")
{
    OneConsumer one(streaming());
    one.stalled = true;
    CHECK(one.offer(emission(1, false, 10)) == Sequences{1});
    CHECK(one.offer(emission(2, false, Subscription::max_queued_bytes)).empty());
    CHECK(one.offer(emission(3, false, 10)) == Sequences{3});
    CHECK(one.ledger().of(Fate::dropped) == 1);
}

TEST_CASE(
    "one consumer: a stream may be behind for a while; then two events wait, or a few small ones, until it is not")
{
    OneConsumer one(streaming());
    one.stalled = true;
    constexpr std::size_t image = 100'000;
    const auto offer = [&](int count, std::size_t bytes) {
        for (int i = 0; i < count; ++i)
            one.offer(emission(1, false, bytes));
    };
    offer(9, image);
    CHECK(one.subscription.waiting() == 8);
    one.now += Subscription::max_behind;
    offer(1, image);
    CHECK(one.subscription.waiting() == 2);
    CHECK(one.ledger().of(Fate::dropped) == 7);
    offer(100, 100);
    CHECK(one.subscription.waiting() == 100);  // the last images were dropped, what is small may wait
    while (one.subscription.waiting() > 0)
        one.written(image);
    offer(9, image);
    CHECK(one.subscription.waiting() > 2);  // another burst
    CHECK(balanced(one.ledger()));
}

TEST_CASE("one consumer: a stream of small events queues a thousand, not more")
{
    OneConsumer one(streaming());
    one.stalled = true;
    for (int i = 1; i <= 3000; ++i)
        one.offer(i);
    CHECK(one.ledger().in_flight()
          == static_cast<std::int64_t>(Subscription::max_queued_events + Credit::most_lane_events));
    CHECK(balanced(one.ledger()));
}

TEST_CASE("one consumer: of a lossless stream 64 are in hand at most, and the next follow what was worked on")
{
    OneConsumer one(streaming());
    for (int i = 1; i <= 100; ++i)
        one.offer(i, true);
    CHECK(one.told.size() == 64);
    CHECK(one.subscription.waiting() == 36);
    CHECK(one.subscription.backlogged());
    CHECK_FALSE(one.subscription.asks());
    CHECK(one.subscription.why() == Reason::not_asked);
    CHECK(one.ask({.asked = 0, .worked = 3, .done = 0}) == Sequences{65, 66, 67});
    CHECK(one.ledger().of(Fate::dropped) == 0);
    one.ask({.asked = 0, .worked = 67, .done = 67});
    CHECK_FALSE(one.subscription.backlogged());
    CHECK(one.subscription.asks());
    CHECK(balanced(one.ledger()));
}

TEST_CASE("one consumer: who works on everything and acknowledges nothing gets 256 events more than its window")
{
    for (const bool streams : {false, true}) {
        OneConsumer one(streams ? streaming() : window(3));
        const auto most = (streams ? Credit::most_streamed : 3) + Credit::most_under_way;
        for (std::int64_t i = 1; i <= most + 10; ++i) {
            one.offer(i, true);
            one.ask({.asked = i + 3, .worked = i, .done = 0});
        }
        CHECK(std::ssize(one.told) == most);
        CHECK(one.subscription.waiting() == 10);
        CHECK_FALSE(one.subscription.asks());
        CHECK(one.subscription.why() == Reason::not_acknowledged);
        CHECK(one.ask({.asked = most + 20, .worked = most, .done = 2}) == Sequences{most + 1, most + 2});
        CHECK(one.ledger().of(Fate::acknowledged) == 2);
        CHECK(balanced(one.ledger()));
    }
}

TEST_CASE("one consumer: who processes nothing of a live stream gets 65,536 events, and then others are dropped")
{
    OneConsumer one(streaming());
    for (std::int64_t i = 1; i <= Credit::most_unprocessed + 10; ++i)
        one.offer(i);
    CHECK(std::ssize(one.told) == Credit::most_unprocessed);
    CHECK(one.subscription.why() == Reason::not_acknowledged);
    const auto waiting = one.subscription.waiting();
    CHECK(waiting + one.ledger().of(Fate::dropped) == 10);
    CHECK(std::ssize(one.ask({.asked = 0, .worked = 100, .done = 0})) == waiting);  // one that it keeps stops nothing
    CHECK(balanced(one.ledger()));
}

TEST_CASE("one consumer: an event of a source on demand is never replaced by a newer one")
{
    OneConsumer one(window(1));
    CHECK(one.offer(1, true) == Sequences{1});
    CHECK(one.offer(2, true).empty());
    CHECK(one.offer(3, true).empty());
    CHECK(one.subscription.backlogged());
    CHECK(one.ask(2, 1) == Sequences{2});
    CHECK(one.ask(3, 2) == Sequences{3});
    CHECK_FALSE(one.subscription.backlogged());
    CHECK(one.ledger().of(Fate::skipped) == 0);
}

TEST_CASE("one consumer: among live events one that is lossless is not replaced")
{
    OneConsumer one(window(1));
    CHECK(one.offer(1) == Sequences{1});
    CHECK(one.offer(2, true).empty());
    CHECK(one.offer(3).empty());
    CHECK(one.offer(4).empty());
    CHECK(one.ask(2) == Sequences{2});
    CHECK(one.ask(3) == Sequences{4});
    CHECK(one.ledger().of(Fate::skipped) == 1);
}

TEST_CASE("one consumer: whoever only watches a lossless source holds it up no more than a live one")
{
    auto options = window(1);
    options.delivery = Delivery::notification;
    OneConsumer one(options);
    CHECK(one.offer(1, true) == Sequences{1});
    one.offer(2, true);
    one.offer(3, true);
    CHECK_FALSE(one.subscription.backlogged());
    CHECK(one.ask(2, 1) == Sequences{3});
    CHECK(one.ledger().of(Fate::skipped) == 1);
}

TEST_CASE("one consumer: says why nothing moves")
{
    OneConsumer one(window(1));
    CHECK(one.subscription.why() == Reason::none);
    one.offer(1);
    CHECK(one.subscription.why() == Reason::not_asked);
    one.ask(2, 1);
    CHECK(one.subscription.why() == Reason::none);
}

}  // namespace hive::event
