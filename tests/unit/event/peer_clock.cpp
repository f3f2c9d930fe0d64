// The clock of a peer, from questions and answers at times of the test's own.
#include <hive/event/peer_clock.hpp>

#include <doctest/doctest.h>

namespace hive::event {
namespace {

using namespace std::chrono_literals;
using Microseconds = std::chrono::microseconds;

constexpr std::int64_t wall_begin_us = 1'700'000'000'000'000;

/// A question at a time, answered by a peer whose clock is ahead, after the ways there and back.
void ask_peer(PeerClock& clock, Microseconds at, Microseconds there, Microseconds back, Microseconds ahead)
{
    const Clock::time_point begin{};
    clock.answered(begin + at, begin + at + there + back, wall_begin_us + at.count(),
                   wall_begin_us + (at + there + ahead).count());
}

}  // namespace

TEST_CASE("peer clock: nothing is known before the first answer")
{
    const PeerClock clock;
    CHECK_FALSE(clock.known());
    CHECK(clock.offset_us() == 0);
    CHECK(clock.round_trip_us() == 0);
}

TEST_CASE("peer clock: the offset is right when both ways take the same time, and off by half the difference at most")
{
    for (const auto ahead : {Microseconds(0), Microseconds(250ms), Microseconds(-1h)}) {
        PeerClock clock;
        ask_peer(clock, 0us, 50ms, 50ms, ahead);
        CHECK(clock.offset_us() == ahead.count());
        CHECK(clock.round_trip_us() == 100'000);
    }
    PeerClock clock;
    ask_peer(clock, 0us, 10ms, 30ms, 0us);
    CHECK(clock.offset_us() == -10'000);
}

TEST_CASE("peer clock: an answer that was held up does not count beside one that was not")
{
    PeerClock clock;
    ask_peer(clock, 0s, 5ms, 800ms, 1s);
    ask_peer(clock, 2s, 5ms, 5ms, 1s);
    ask_peer(clock, 4s, 900ms, 5ms, 1s);
    CHECK(clock.offset_us() == 1'000'000);
    CHECK(clock.round_trip_us() == 10'000);
}

TEST_CASE("peer clock: a clock that was set is followed, although the round trips were shorter before")
{
    PeerClock clock;
    ask_peer(clock, 0s, 1ms, 1ms, 0s);
    for (int i = 1; i <= 8; ++i)
        ask_peer(clock, i * 2s, 2ms, 2ms, 3600s);
    CHECK(clock.offset_us() == 3'600'000'000);
}

TEST_CASE("peer clock: the first questions follow each other, later ones come every 2 s")
{
    PeerClock clock;
    CHECK(clock.due() < Clock::time_point{} + 1s);
    ask_peer(clock, 10s, 1ms, 1ms, 0s);
    CHECK(clock.due() <= Clock::time_point{} + 10'100ms);
    ask_peer(clock, 11s, 1ms, 1ms, 0s);
    ask_peer(clock, 12s, 1ms, 1ms, 0s);
    CHECK(clock.due() == Clock::time_point{} + 14'002ms);
}

}  // namespace hive::event
