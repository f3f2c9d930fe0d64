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
    peer.excuse(10s);
    CHECK_FALSE(peer.verdict(zero + 11s, false));
    CHECK(peer.verdict(zero + 12s, false));
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
    own.answered(zero + 1s, 0);
    CHECK_FALSE(own.probe_due(zero + 1999ms));
    CHECK(own.probe_due(zero + 2s));
}

TEST_CASE("liveness: a peer may have heard nothing since the last ping that it answered, and takes this end for dead 2 "
          "s later")
{
    Liveness own(standard, zero);
    own.hello_came();
    CHECK_FALSE(own.seemed_dead(zero + 1999ms));
    CHECK(own.seemed_dead(zero + 2s));
    own.pinged(zero + 1s);
    own.heard(zero + 1200ms, 1, true);  // something else
    CHECK(own.seemed_dead(zero + 2s));
    own.answered(zero + 1s, 0);
    CHECK_FALSE(own.seemed_dead(zero + 2999ms));
    CHECK(own.seemed_dead(zero + 3s));
    own.pinged(zero + 2s);
    own.pinged(zero + 3s);
    own.answered(zero + 2s, 1);  // the first of the two
    CHECK_FALSE(own.seemed_dead(zero + 3999ms));
    CHECK(own.seemed_dead(zero + 4s));
    own.excuse(5s);
    CHECK(own.seemed_dead(zero + 4s));  // the peer was not suspended
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
