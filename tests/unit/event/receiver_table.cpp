// The receiver table without groups: credit, windows, streams, notifications, demand.
#include "fixtures.hpp"

#include <doctest/doctest.h>

namespace hive::event {
namespace {

/// A table with one receiver, number 1, and a transport that writes at once.
struct OneReceiver {
    explicit OneReceiver(const ConnectionOptions& options) { table.add(1, "face.image", epoch, options, start); }

    Sequences offer(std::int64_t sequence, bool lossless = false)
    {
        return deliver(table.offer(emission(sequence, lossless), false, start));
    }
    Sequences ask(std::int64_t id, std::int64_t done = 0) { return deliver(table.request(1, epoch, id, done, start)); }
    Sequences deliver(const ReceiverTable::Decisions& decisions)
    {
        Sequences all = sequences(decisions);
        for (const auto& send : decisions.sends)
            for (const auto sequence : deliver(table.written(send.receiver, send.event->size(), start)))
                all.push_back(sequence);
        return all;
    }
    [[nodiscard]] Counts counts() const { return table.rows().front().counts; }

    ReceiverTable table;
};

}  // namespace

TEST_CASE("receiver table: a synchronized receiver gets one event and then nothing until it asks")
{
    OneReceiver one(window(1));
    CHECK(one.offer(1) == Sequences{1});
    CHECK(one.offer(2).empty());
    CHECK(one.ask(2) == Sequences{2});
}

TEST_CASE("receiver table: what waits for a request is the newest")
{
    OneReceiver one(window(1));
    one.offer(1);
    for (int i = 2; i <= 9; ++i)
        CHECK(one.offer(i).empty());
    CHECK(one.ask(2) == Sequences{9});
    CHECK(one.counts().skipped == 7);
    CHECK(balanced(one.counts()));
}

TEST_CASE("receiver table: the same event is never sent twice to one receiver")
{
    OneReceiver one(window(1));
    one.offer(1);
    CHECK(one.ask(2).empty());
    CHECK(one.ask(3).empty());
    CHECK(one.offer(2) == Sequences{2});
}

TEST_CASE("receiver table: a window of three lets three go before the first answer")
{
    OneReceiver one(window(3));
    CHECK(one.offer(1) == Sequences{1});
    CHECK(one.offer(2) == Sequences{2});
    CHECK(one.offer(3) == Sequences{3});
    CHECK(one.offer(4).empty());
    CHECK(one.ask(4) == Sequences{4});
}

TEST_CASE("receiver table: a repeated or late request neither wedges nor sends twice")
{
    OneReceiver one(window(1));
    one.offer(1);
    one.ask(2);
    CHECK(one.ask(2).empty());
    CHECK(one.ask(1).empty());
    CHECK(one.offer(2) == Sequences{2});
    CHECK(one.offer(3).empty());
    CHECK(one.ask(2).empty());
    CHECK(one.ask(3) == Sequences{3});
}

TEST_CASE("receiver table: a request of another registration is ignored")
{
    OneReceiver one(window(1));
    one.offer(1);
    one.offer(2);
    CHECK(one.table.request(1, epoch - 1, 100, 100, start).sends.empty());
    CHECK(one.ask(2) == Sequences{2});
}

TEST_CASE("receiver table: asking for a billion gives no more than the window")
{
    OneReceiver one(window(2));
    one.offer(1);
    one.ask(1'000'000'000);
    CHECK(one.offer(2) == Sequences{2});
    CHECK(one.offer(3) == Sequences{3});
    CHECK(one.offer(4).empty());
}

TEST_CASE("receiver table: a stream gets every event in order")
{
    OneReceiver one(streaming());
    for (int i = 1; i <= 100; ++i)
        CHECK(one.offer(i) == Sequences{i});
    CHECK(one.counts().delivered == 100);
}

TEST_CASE("receiver table: a stream whose transport stands still keeps the newest and counts the rest")
{
    ReceiverTable table;
    table.add(1, "slow", epoch, streaming(), start);
    const std::size_t picture = ReceiverTable::most_queued_bytes;
    for (int i = 1; i <= 20; ++i)
        table.offer(emission(i, false, picture), false, start);
    const auto counts = table.rows().front().counts;
    CHECK(counts.produced == 20);
    CHECK(counts.in_flight == 2);  // one with the transport, the newest behind it
    CHECK(counts.dropped == 18);
    CHECK(balanced(counts));
    CHECK(sequences(table.written(1, picture, start)) == Sequences{20});
}

TEST_CASE("receiver table: a stream of small events queues a thousand, not more")
{
    ReceiverTable table;
    table.add(1, "slow", epoch, streaming(), start);
    for (int i = 1; i <= 3000; ++i)
        table.offer(emission(i), false, start);
    const auto counts = table.rows().front().counts;
    CHECK(counts.in_flight <= static_cast<std::int64_t>(ReceiverTable::most_queued_events) + 64);
    CHECK(balanced(counts));
}

TEST_CASE("receiver table: a notification receiver makes no body wanted")
{
    ReceiverTable table;
    CHECK_FALSE(table.wanted());
    const auto decisions = [&] {
        table.add(1, "top", epoch, streaming(Delivery::notification), start);
        return table.offer(emission(1), false, start);
    }();
    CHECK_FALSE(table.wanted());
    REQUIRE(decisions.sends.size() == 1);
    CHECK(decisions.sends[0].delivery == Delivery::notification);
}

TEST_CASE("receiver table: an event of a source on demand is never replaced by a newer one")
{
    OneReceiver one(window(1));
    CHECK(one.offer(1, true) == Sequences{1});
    CHECK(one.offer(2, true).empty());
    CHECK(one.offer(3, true).empty());
    CHECK(one.table.backlogged());
    CHECK(one.ask(2) == Sequences{2});
    CHECK(one.ask(3) == Sequences{3});
    CHECK_FALSE(one.table.backlogged());
    CHECK(one.counts().skipped == 0);
}

TEST_CASE("receiver table: among live events one that is lossless is not replaced")
{
    OneReceiver one(window(1));
    CHECK(one.offer(1) == Sequences{1});
    CHECK(one.offer(2, true).empty());
    CHECK(one.offer(3).empty());
    CHECK(one.offer(4).empty());
    CHECK(one.ask(2) == Sequences{2});
    CHECK(one.ask(3) == Sequences{4});
    CHECK(one.counts().skipped == 1);
}

TEST_CASE("receiver table: demand is there when every receiver of bodies has asked")
{
    ReceiverTable table;
    CHECK_FALSE(table.asked());
    table.add(1, "fast", epoch, window(1), start);
    CHECK(table.asked());
    table.add(2, "slow", epoch, window(1), start);
    table.add(3, "top", epoch, streaming(Delivery::notification), start);
    table.offer(emission(1, true), false, start);
    CHECK_FALSE(table.asked());
    table.written(1, 10, start);
    table.written(2, 10, start);
    table.request(1, epoch, 2, 1, start);
    CHECK_FALSE(table.asked());
    table.request(2, epoch, 2, 1, start);
    CHECK(table.asked());
}

TEST_CASE("receiver table: a lossless event without any receiver waits for the first one")
{
    ReceiverTable table;
    CHECK(table.offer(emission(1, true), true, start).sends.empty());
    CHECK(table.backlogged());
    CHECK(sequences(table.add(1, "results", epoch, window(1), start)) == Sequences{1});
    CHECK_FALSE(table.backlogged());
}

TEST_CASE("receiver table: first_frame begins with the newest event that there is")
{
    ReceiverTable table;
    table.offer(emission(1), false, start);
    table.offer(emission(2), false, start);
    auto options = window(1);
    CHECK(table.add(1, "late", epoch, options, start).sends.empty());
    options.first_frame = true;
    CHECK(sequences(table.add(2, "early", epoch, options, start)) == Sequences{2});
}

TEST_CASE("receiver table: an event whose body nobody wanted goes to notifications only")
{
    ReceiverTable table;
    table.add(1, "face", epoch, window(1), start);
    table.add(2, "top", epoch, streaming(Delivery::notification), start);
    const auto bodiless = std::make_shared<const Emission>(emission(1)->event(), false);
    const auto decisions = table.offer(bodiless, false, start);
    REQUIRE(decisions.sends.size() == 1);
    CHECK(decisions.sends[0].receiver == 2);
    auto late = window(1);
    late.first_frame = true;
    CHECK(table.add(3, "snap", epoch, late, start).sends.empty());
}

TEST_CASE("receiver table: an event is acknowledged once its receivers of bodies have it, whoever keeps or watches it")
{
    ReceiverTable table;
    table.add(1, "collector", epoch, window(2), start);
    table.add(
        2, "watcher that asks no more", epoch,
        [] {
            auto options = window(1);
            options.delivery = Delivery::notification;
            return options;
        }(),
        start);
    table.offer(emission(1), false, start);
    bool acknowledged = false;
    Event event = emission(2, true)->event();
    event.receipt = {&acknowledged, [&](const void*) { acknowledged = true; }};
    auto offered = std::make_shared<const Emission>(std::move(event));
    auto decisions = table.offer(std::move(offered), false, start);
    REQUIRE(decisions.sends.size() == 1);
    CHECK_FALSE(acknowledged);
    decisions.sends.clear();  // written
    CHECK(acknowledged);
}

TEST_CASE("receiver table: a removed receiver gets nothing, and nobody else notices")
{
    ReceiverTable table;
    table.add(1, "a", epoch, streaming(), start);
    table.add(2, "b", epoch, streaming(), start);
    table.remove(1, true, start);
    const auto decisions = table.offer(emission(1), false, start);
    REQUIRE(decisions.sends.size() == 1);
    CHECK(decisions.sends[0].receiver == 2);
    CHECK(table.written(1, 10, start).sends.empty());
    CHECK(table.request(1, epoch, 5, 5, start).sends.empty());
}

}  // namespace hive::event
