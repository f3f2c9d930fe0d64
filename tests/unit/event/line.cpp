// What a plain receiver gets when: credit, windows, streams, what is skipped and what is not.
#include "line_fixtures.hpp"

#include <doctest/doctest.h>

namespace hive::event {

TEST_CASE("line: a synchronized receiver gets one event and then nothing until it asks")
{
    OneLine one(window(1));
    CHECK(one.offer(1) == Sequences{1});
    CHECK(one.offer(2).empty());
    CHECK(one.ask(2) == Sequences{2});
}

TEST_CASE("line: what waits for a request is the newest")
{
    OneLine one(window(1));
    one.offer(1);
    for (int i = 2; i <= 9; ++i)
        CHECK(one.offer(i).empty());
    CHECK(one.ask(2) == Sequences{9});
    CHECK(one.ledger.of(Fate::skipped) == 7);
    CHECK(one.ledger.in_flight() == 2);
    CHECK(balanced(one.ledger));
}

TEST_CASE("line: the same event is never sent twice to one receiver")
{
    OneLine one(window(1));
    one.offer(1);
    CHECK(one.ask(2).empty());
    CHECK(one.ask(3).empty());
    CHECK(one.offer(2) == Sequences{2});
}

TEST_CASE("line: a window of three lets three go before the first answer")
{
    OneLine one(window(3));
    CHECK(one.offer(1) == Sequences{1});
    CHECK(one.offer(2) == Sequences{2});
    CHECK(one.offer(3) == Sequences{3});
    CHECK(one.offer(4).empty());
    CHECK(one.ask(4) == Sequences{4});
}

TEST_CASE("line: a repeated or late request neither wedges nor sends twice")
{
    OneLine one(window(1));
    one.offer(1);
    one.ask(2);
    CHECK(one.ask(2).empty());
    CHECK(one.ask(1).empty());
    CHECK(one.offer(2) == Sequences{2});
    CHECK(one.offer(3).empty());
    CHECK(one.ask(2).empty());
    CHECK(one.ask(3) == Sequences{3});
}

TEST_CASE("line: a request of another registration is ignored")
{
    OneLine one(window(1));
    one.offer(1);
    one.offer(2);
    const auto decisions = decided([&](Decisions& to) { one.line.request(epoch - 1, {100, 100, 100}, to); });
    CHECK(decisions.sends.empty());
    CHECK(one.ledger.of(Fate::acknowledged) == 0);
    CHECK(one.ask(2) == Sequences{2});
}

TEST_CASE("line: asking for a billion gives no more than the window")
{
    OneLine one(window(2));
    one.offer(1);
    one.ask(1'000'000'000);
    CHECK(one.offer(2) == Sequences{2});
    CHECK(one.offer(3) == Sequences{3});
    CHECK(one.offer(4).empty());
}

TEST_CASE("line: who claims to have done more than it was sent has done what it was sent")
{
    OneLine one(window(2));
    one.offer(1);
    one.ask(1'000'000'000, 1'000'000'000);
    CHECK(one.ledger.of(Fate::acknowledged) == 1);
    one.offer(2);
    CHECK(one.ledger.in_flight() == 1);
    CHECK(balanced(one.ledger));
}

TEST_CASE("line: an event is acknowledged when the receiver has done it, not when it was written")
{
    OneLine one(streaming());
    for (int i = 1; i <= 100; ++i)
        CHECK(one.offer(i) == Sequences{i});
    CHECK(one.ledger.of(Fate::acknowledged) == 0);
    CHECK(one.ledger.in_flight() == 100);
    one.ask(0, 60);
    CHECK(one.ledger.of(Fate::acknowledged) == 60);
    CHECK(one.ledger.in_flight() == 40);
    CHECK(balanced(one.ledger));
}

TEST_CASE("line: a stream whose transport stands still keeps the newest and counts the rest")
{
    Ledger ledger;
    Line line(1, "slow", epoch, streaming(), ledger);
    const std::size_t picture = Line::most_queued_bytes;
    Decisions decisions;
    for (int i = 1; i <= 20; ++i)
        line.offer(emission(i, false, picture), {}, decisions);
    CHECK(ledger.total() == 20);
    CHECK(ledger.in_flight() == 2);  // one with the transport, the newest behind it
    CHECK(ledger.of(Fate::dropped) == 18);
    CHECK(line.why() == Reason::lane_full);
    CHECK(balanced(ledger));
    CHECK(sequences(decided([&](Decisions& to) { line.written(picture, to); })) == Sequences{20});
}

TEST_CASE("line: live events that wait behind a lossless one are dropped like others")
{
    OneLine one(streaming());
    int sent = 1;
    while (!one.offer(sent, true).empty())  // until the receiver has to work on some
        REQUIRE(++sent < 1000);
    for (int i = 1; i <= 5000; ++i)
        one.offer(sent + i);
    CHECK(one.line.waiting() <= static_cast<std::int64_t>(Line::most_queued_events));
    CHECK(one.ledger.of(Fate::dropped) >= 5000 - static_cast<std::int64_t>(Line::most_queued_events));
    CHECK(balanced(one.ledger));
}

TEST_CASE("line: what waited behind an event that was dropped goes at once")
{
    Ledger ledger;
    Line line(1, "slow", epoch, streaming(), ledger);
    const auto offer = [&](std::int64_t sequence, std::size_t bytes) {
        return sequences(decided([&](Decisions& to) { line.offer(emission(sequence, false, bytes), {}, to); }));
    };
    CHECK(offer(1, 10) == Sequences{1});
    CHECK(offer(2, Line::most_queued_bytes).empty());
    CHECK(offer(3, 10) == Sequences{3});
    CHECK(ledger.of(Fate::dropped) == 1);
}

TEST_CASE(
    "line: a stream may be behind for a while; then two events wait, or a few that are small, until it catches up")
{
    Ledger ledger;
    Line line(1, "slow", epoch, streaming(), ledger);
    constexpr std::size_t picture = 100'000;
    Decisions decisions;
    Clock::time_point now{};
    const auto offer = [&](int count, std::size_t bytes) {
        for (int i = 0; i < count; ++i)
            line.offer(emission(1, false, bytes), now, decisions);
    };
    offer(9, picture);
    CHECK(line.waiting() == 8);
    now += Line::most_behind;
    offer(1, picture);
    CHECK(line.waiting() == 2);
    CHECK(ledger.of(Fate::dropped) == 7);
    offer(100, 100);
    CHECK(line.waiting() == 100);  // the last pictures were dropped, what is small may wait
    while (line.waiting() > 0)
        line.written(picture, decisions);
    offer(9, picture);
    CHECK(line.waiting() > 2);  // another burst
    CHECK(balanced(ledger));
}

TEST_CASE("line: a stream of small events queues a thousand, not more")
{
    Ledger ledger;
    Line line(1, "slow", epoch, streaming(), ledger);
    Decisions decisions;
    for (int i = 1; i <= 3000; ++i)
        line.offer(emission(i), {}, decisions);
    CHECK(ledger.in_flight() == static_cast<std::int64_t>(Line::most_queued_events + Credit::most_lane_events));
    CHECK(balanced(ledger));
}

TEST_CASE("line: of a lossless stream 64 are in hand at most, and the next follow what was worked on")
{
    OneLine one(streaming());
    for (int i = 1; i <= 100; ++i)
        one.offer(i, true);
    CHECK(one.told.size() == 64);
    CHECK(one.line.waiting() == 36);
    CHECK(one.line.backlogged());
    CHECK_FALSE(one.line.asks());
    CHECK(one.line.why() == Reason::not_asked);
    CHECK(one.ask({.asked = 0, .worked = 3, .done = 0}) == Sequences{65, 66, 67});
    CHECK(one.ledger.of(Fate::dropped) == 0);
    one.ask({.asked = 0, .worked = 67, .done = 67});
    CHECK_FALSE(one.line.backlogged());
    CHECK(one.line.asks());
    CHECK(balanced(one.ledger));
}

TEST_CASE("line: an event of a source on demand is never replaced by a newer one")
{
    OneLine one(window(1));
    CHECK(one.offer(1, true) == Sequences{1});
    CHECK(one.offer(2, true).empty());
    CHECK(one.offer(3, true).empty());
    CHECK(one.line.backlogged());
    CHECK(one.ask(2, 1) == Sequences{2});
    CHECK(one.ask(3, 2) == Sequences{3});
    CHECK_FALSE(one.line.backlogged());
    CHECK(one.ledger.of(Fate::skipped) == 0);
}

TEST_CASE("line: among live events one that is lossless is not replaced")
{
    OneLine one(window(1));
    CHECK(one.offer(1) == Sequences{1});
    CHECK(one.offer(2, true).empty());
    CHECK(one.offer(3).empty());
    CHECK(one.offer(4).empty());
    CHECK(one.ask(2) == Sequences{2});
    CHECK(one.ask(3) == Sequences{4});
    CHECK(one.ledger.of(Fate::skipped) == 1);
}

TEST_CASE("line: whoever only watches a lossless source holds it up no more than a live one")
{
    auto options = window(1);
    options.delivery = Delivery::notification;
    OneLine one(options);
    CHECK(one.offer(1, true) == Sequences{1});
    one.offer(2, true);
    one.offer(3, true);
    CHECK_FALSE(one.line.backlogged());
    CHECK(one.ask(2, 1) == Sequences{3});
    CHECK(one.ledger.of(Fate::skipped) == 1);
}

TEST_CASE("line: says why nothing moves")
{
    OneLine one(window(1));
    CHECK(one.line.why() == Reason::none);
    one.offer(1);
    CHECK(one.line.why() == Reason::not_asked);
    one.ask(2, 1);
    CHECK(one.line.why() == Reason::none);
}

}  // namespace hive::event
