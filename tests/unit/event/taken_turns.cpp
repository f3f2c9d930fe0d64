// A turn is new once, in whatever order turns come, and its acknowledgement keeps back those of its repetitions.
#include <hive/event/taken_turns.hpp>
#include <hive/event/ticket.hpp>

#include <doctest/doctest.h>

#include <random>
#include <set>

namespace hive::event {
namespace {

const Share share{.of = "camera.image", .epoch = 7, .turn = 1, .to = "image"};

Event event_of(std::int64_t turn, bool lossless = true)
{
    Event event;
    event.identity.lossless = lossless;
    event.identity.shares = {share};
    event.identity.shares.back().turn = turn;
    event.ticket = {std::make_shared<Acknowledgement>(), true};
    return event;
}

}  // namespace

TEST_CASE("taken turns: they are of one output or group in one run")
{
    const TakenTurns turns(share);
    CHECK(turns.counts(share));
    auto other = share;
    other.epoch = 8;
    CHECK_FALSE(turns.counts(other));
    other = share;
    other.of = "camera.image#workers";
    CHECK_FALSE(turns.counts(other));
}

TEST_CASE("taken turns: in any order, each is new once")
{
    std::mt19937_64 random(20261130);
    for (int round = 0; round < 200; ++round) {
        TakenTurns turns(share);
        std::set<std::int64_t> taken;
        for (int step = 0; step < 200; ++step) {
            const auto turn = 1 + static_cast<std::int64_t>(random() % 100);
            INFO("round " << round << ", step " << step << ", turn " << turn);
            REQUIRE(turns.take(event_of(turn)) == taken.insert(turn).second);
        }
    }
}

TEST_CASE("taken turns: of too many gaps the lowest are forgotten, and the others are still known")
{
    TakenTurns turns(share);
    constexpr std::int64_t most = TakenTurns::most_gaps;
    for (std::int64_t i = 0; i <= most; ++i)
        REQUIRE(turns.take(event_of(2 * i)));
    CHECK_FALSE(turns.take(event_of(2)));
    CHECK_FALSE(turns.take(event_of(2 * most)));
    CHECK(turns.take(event_of(0)));
}

TEST_CASE("taken turns: an event that comes again is acknowledged after the first, unless it may be lost")
{
    for (const bool lossless : {true, false}) {
        TakenTurns turns(share);
        auto first = event_of(1), again = event_of(1, lossless);
        const std::weak_ptr<Acknowledgement> owed = again.ticket.owed();
        REQUIRE(turns.take(first));
        REQUIRE_FALSE(turns.take(again));
        again = {};
        CHECK(owed.expired() == !lossless);
        first = {};
        CHECK(owed.expired());
    }
}

TEST_CASE("taken turns: with many in hand at once, a repetition still waits for its own")
{
    TakenTurns turns(share);
    std::vector<Event> in_hand;
    for (std::int64_t turn = 1; turn <= 200; ++turn) {
        in_hand.push_back(event_of(turn));
        REQUIRE(turns.take(in_hand.back()));
        auto passing = event_of(1000 + turn);  // acknowledged at once
        REQUIRE(turns.take(passing));
    }
    auto again = event_of(3);
    const std::weak_ptr<Acknowledgement> owed = again.ticket.owed();
    REQUIRE_FALSE(turns.take(again));
    again = {};
    in_hand.erase(in_hand.begin() + 3, in_hand.end());
    CHECK_FALSE(owed.expired());
    in_hand.clear();
    CHECK(owed.expired());
}

}  // namespace hive::event
