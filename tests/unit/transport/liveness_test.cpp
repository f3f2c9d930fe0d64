// The heartbeat rules, by a clock that the test turns.
#include "liveness.hpp"

#include <doctest/doctest.h>

using namespace hive::transport;
using namespace std::chrono_literals;
using hive::Errc;

namespace {

const Liveness::Clock::time_point zero{};
constexpr Timing standard{};

}  // namespace

TEST_CASE("liveness: no hello within its time is a timeout, whatever bytes came")
{
    Liveness peer(standard, zero);
    peer.heard(zero + 1900ms, 10, true);
    CHECK_FALSE(peer.verdict(zero + 1999ms, true));
    CHECK(peer.verdict(zero + 2000ms, true)->code() == Errc::timeout);
}

TEST_CASE("liveness: any byte is a sign of life, and two seconds of silence are death")
{
    Liveness peer(standard, zero);
    peer.hello_came();
    peer.heard(zero + 1s, 1, true);
    CHECK_FALSE(peer.verdict(zero + 2999ms, false));
    const auto verdict = peer.verdict(zero + 3s, false);
    REQUIRE(verdict);
    CHECK(verdict->code() == Errc::connection_lost);
    CHECK(std::string(verdict->what()) == "no sign of life for 2 s");
}

TEST_CASE("liveness: the time in which this end itself was held up does not count")
{
    Liveness peer(standard, zero);
    peer.hello_came();
    peer.heard(zero, 1, true);
    peer.excuse(10s, zero + 10s);
    CHECK_FALSE(peer.verdict(zero + 11s, false));
    CHECK(peer.verdict(zero + 12s, false));
}

TEST_CASE("liveness: an end that is held up for 1.5 s may be taken for dead, until 1 s after it goes on")
{
    Liveness own(standard, zero);
    CHECK_FALSE(own.seemed_dead(1499ms, zero + 1500ms));
    CHECK(own.seemed_dead(1500ms, zero + 1500ms));
    own.excuse(1499ms, zero + 1500ms);
    CHECK_FALSE(own.seemed_dead(0s, zero + 1500ms));
    own.excuse(1500ms, zero + 3s);
    own.pinged(zero + 3s);
    own.answered(zero + 3s, 0);
    CHECK(own.seemed_dead(0s, zero + 3999ms));
    CHECK_FALSE(own.seemed_dead(0s, zero + 4s));
}

TEST_CASE("liveness: a ping is due after a pause in sending, but never before the first packet")
{
    Liveness peer(standard, zero);
    CHECK_FALSE(peer.ping_due(zero + 10s));
    peer.sent(zero + 1s);
    CHECK_FALSE(peer.ping_due(zero + 1499ms));
    CHECK(peer.ping_due(zero + 1500ms));
}

TEST_CASE("liveness: a ping is due each second, whatever else is sent, while all pings are answered")
{
    Liveness own(standard, zero);
    CHECK_FALSE(own.probe_due(zero + 10s));
    own.sent(zero);
    own.heard(zero, 1, true);
    CHECK_FALSE(own.probe_due(zero + 999ms));
    CHECK(own.probe_due(zero + 1s));
    own.sent(zero + 900ms);  // answers
    CHECK(own.probe_due(zero + 1s));
    CHECK(own.next_look(zero + 900ms, false) == zero + 1s);
    own.pinged(zero + 1s);
    CHECK_FALSE(own.probe_due(zero + 10s));
    own.answered(zero + 1100ms, 0);
    CHECK_FALSE(own.probe_due(zero + 1999ms));
    CHECK(own.probe_due(zero + 2s));
}

TEST_CASE("liveness: who sends something and has not answered a ping by then may not hear this end")
{
    Liveness own(standard, zero);
    own.hello_came();
    own.sent(zero);
    own.pinged(zero + 1s);
    own.heard(zero + 1249ms, 1, true);
    CHECK_FALSE(own.seemed_dead(0s, zero + 1999ms));  // frozen since then, or killed
    own.heard(zero + 1250ms, 1, true);
    CHECK(own.seemed_dead(0s, zero + 1999ms));
    own.pinged(zero + 2s);
    own.answered(zero + 2s, 1);  // the second ping has no answer yet
    own.heard(zero + 2249ms, 1, true);
    CHECK_FALSE(own.seemed_dead(0s, zero + 2999ms));
    own.answered(zero + 2249ms, 0);
    own.heard(zero + 3s, 1, true);
    CHECK_FALSE(own.seemed_dead(0s, zero + 3s));
}

TEST_CASE("liveness: whose last answer is to a ping of 2 s ago may have heard nothing since")
{
    Liveness own(standard, zero);
    own.hello_came();
    CHECK_FALSE(own.seemed_dead(0s, zero + 1999ms));
    CHECK(own.seemed_dead(0s, zero + 2s));
    own.pinged(zero + 1s);
    own.answered(zero + 1300ms, 0);
    CHECK_FALSE(own.seemed_dead(0s, zero + 2999ms));
    CHECK(own.seemed_dead(0s, zero + 3s));
}

TEST_CASE("liveness: the time in which this end was blocked does not count against an answer")
{
    Liveness own(standard, zero);
    own.sent(zero);
    own.heard(zero, 1, true);
    own.pinged(zero);
    own.excuse(1s, zero + 1s);
    own.heard(zero + 1249ms, 1, true);
    CHECK_FALSE(own.seemed_dead(0s, zero + 1999ms));
}

TEST_CASE("liveness: a packet must come at 64 KiB/s, in every window")
{
    Liveness peer(standard, zero);
    peer.hello_came();
    peer.heard(zero, 1, true);
    for (auto time = 1s; time <= 4s; time += 1s)
        peer.heard(zero + time, 100 * 1024, false);
    CHECK_FALSE(peer.verdict(zero + 5s, true));  // 80 KiB/s: another window
    for (auto time = 6s; time <= 10s; time += 1s)
        peer.heard(zero + time, 1024, false);
    CHECK_FALSE(peer.verdict(zero + 9900ms, true));
    CHECK(peer.verdict(zero + 10s, true)->code() == Errc::timeout);
    CHECK_FALSE(peer.verdict(zero + 10s, false));  // between packets nobody hurries
}

TEST_CASE("liveness: the next look is at what becomes due first")
{
    Liveness peer(standard, zero);
    CHECK(peer.next_look(zero, false) == zero + 500ms);
    peer.hello_came();
    peer.sent(zero);
    peer.pinged(zero);  // not answered
    peer.heard(zero, 1, true);
    CHECK(peer.next_look(zero, false) == zero + 500ms);
    peer.sent(zero + 1900ms);
    CHECK(peer.next_look(zero + 1900ms, false) == zero + 2s);
    peer.heard(zero + 4s, 1, true);
    CHECK(peer.next_look(zero + 4s, false) == zero + 4500ms);  // the ping is overdue because the peer does not read
    CHECK(peer.next_look(zero + 6s, false) == zero + 6s + 1ms);
}

TEST_CASE("liveness: durations read well")
{
    CHECK(duration_text(2000ms) == "2 s");
    CHECK(duration_text(150ms) == "150 ms");
}
