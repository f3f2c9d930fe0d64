// What a receiver that dies or holds work for too long is said to have failed at.
#include "one_consumer.hpp"
#include "workers.hpp"

#include <doctest/doctest.h>

namespace hive::event {
namespace {

/// What it had in hand when it was lost; negative: it had finished with it.
Sequences failed_at(OneConsumer& one, Fate how)
{
    Sequences all;
    for (const auto& failed : decided([&](Decisions& to) {
                                  one.subscription.detach(1, how, how != Fate::lost_left, one.now, to);
                              }).failed_at)
        all.push_back(failed.worked ? -sequence_of(failed.event) : sequence_of(failed.event));
    return all;
}

}  // namespace

TEST_CASE("failed at: the first event that a dead receiver had not processed, be it live or lossless")
{
    for (const bool lossless : {false, true}) {
        CAPTURE(lossless);
        OneConsumer one(window(3));
        for (int i = 1; i <= 3; ++i)
            one.offer(i, lossless);
        one.ask(Progress{3, 1, 0});
        CHECK(failed_at(one, Fate::lost_killed) == Sequences{-1, 2});  // 1 was not acknowledged
    }
}

TEST_CASE("failed at: nothing, if it had finished, has left, or lives on without its connection")
{
    OneConsumer finished(window(1));
    finished.offer(1);
    finished.ask(2, 1);
    CHECK(failed_at(finished, Fate::lost_killed).empty());
    for (const auto how : {Fate::lost_left, Fate::lost_connection}) {
        OneConsumer one(window(1));
        one.offer(1);
        CHECK(failed_at(one, how).empty());
    }
}

TEST_CASE("failed at: who only looks on, or gets no bodies, keeps nothing")
{
    OneConsumer passive(window(1), true);
    passive.offer(1);
    CHECK(failed_at(passive, Fate::lost_killed).empty());
    OneConsumer notified(streaming(Delivery::notification));
    notified.offer(1);
    CHECK(failed_at(notified, Fate::lost_killed).empty());
}

TEST_CASE("failed at: live events are let go when they are acknowledged, and are bounded by number and size")
{
    OneConsumer one(streaming());
    std::vector<std::weak_ptr<const Emission>> events;
    const auto offer = [&](std::int64_t sequence, std::size_t bytes) {
        const auto event = emission(sequence, false, bytes);
        events.emplace_back(event);
        one.offer(event);
    };
    const auto kept = [&] { return std::ranges::count_if(events, [](const auto& each) { return !each.expired(); }); };
    for (int i = 1; i <= 100; ++i)
        offer(i, 10);
    CHECK(kept() == static_cast<std::ptrdiff_t>(Subscription::max_shown_events));
    one.ask(100, 100);
    CHECK(kept() == 0);
    for (int i = 1; i <= 4; ++i)
        offer(100 + i, 12u << 20);
    CHECK(kept() == 2);
    CHECK(failed_at(one, Fate::lost_cut_off) == Sequences{101, 102});  // of a stream it is one of those
}

TEST_CASE("failed at: a member whose lease expires has failed at what it had first")
{
    Subscription shared({.shared_as = "camera.image#workers", .epoch = 1});
    Subscription::Member own;
    auto now = start;
    const auto lease = std::chrono::milliseconds(100);
    decided([&](Decisions& to) { shared.attach(1, sharing(lease, 2), {}, &own, now, to); });
    for (int i = 1; i <= 2; ++i)
        decided([&](Decisions& to) { shared.offer(emission(i), now, to); });
    now += 2 * lease;
    const auto decisions = decided([&](Decisions& to) { shared.tick(now, to); });
    REQUIRE(decisions.failed_at.size() == 1);
    CHECK(sequence_of(decisions.failed_at.front().event) == 1);
}

}  // namespace hive::event
