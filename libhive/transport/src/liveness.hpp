// Decides from clock readings whether a peer is alive, late or dead. Has no timer.
#pragma once

#include <hive/error.hpp>
#include <hive/platform/clock.hpp>
#include <hive/transport/connection.hpp>

#include <chrono>
#include <optional>

namespace hive::transport {

/// The heartbeat rules of one connection.
class Liveness {
public:
    using Clock = platform::SteadyClock;

    Liveness(const Timing& timing, Clock::time_point now)
        : timing_(timing), started_(now), heard_(now), received_(now), probed_(now), window_(now)
    {
    }

    /// The peer's first packet is complete.
    void hello_came() { hello_ = true; }
    /// Bytes were sent.
    void sent(Clock::time_point now) { sent_ = now; }
    /// A ping is being sent.
    void pinged(Clock::time_point now);
    /// The oldest unanswered ping was answered.
    /// @param sent        when it was sent
    /// @param unanswered  number of pings that are still unanswered
    void answered(Clock::time_point sent, std::size_t unanswered);
    /// Bytes arrived. `fresh`: they begin or end a packet.
    void heard(Clock::time_point now, std::size_t bytes, bool fresh);

    /// This end was blocked for this long: the peer is not to blame.
    void excuse(Clock::duration late);

    /// May the peer have declared this end dead? Not before `silence` is over since the last ping that it answered.
    [[nodiscard]] bool seemed_dead(Clock::time_point now) const { return now >= received_ + timing_.silence; }
    /// A ping is due: something was sent once (so the hello is first), but not lately.
    [[nodiscard]] bool ping_due(Clock::time_point now) const { return sent_ && now >= *sent_ + timing_.heartbeat; }
    /// A ping is due whatever else was sent: events, and answers to pings, do not show whether the peer receives them.
    [[nodiscard]] bool probe_due(Clock::time_point now) const
    {
        return sent_ && !unanswered_ && now >= probed_ + 2 * timing_.heartbeat;
    }
    /// Why the connection must end now, if it must. `inside`: a packet has begun and is incomplete.
    std::optional<Error> verdict(Clock::time_point now, bool inside);
    /// The time of the next check, at the latest when anything becomes due.
    [[nodiscard]] Clock::time_point next_look(Clock::time_point now, bool inside) const;

private:
    [[nodiscard]] bool too_slow(Clock::time_point now);

    Timing timing_;
    Clock::time_point started_, heard_;
    Clock::time_point received_;  ///< when the last ping was sent that the peer answered; at first the start
    Clock::time_point probed_;    ///< the last ping, at first the start
    std::optional<Clock::time_point> sent_;
    bool unanswered_ = false;  ///< is there a ping without an answer?
    bool hello_ = false;
    Clock::time_point window_;  ///< since when the bytes of the current packet are counted
    std::size_t window_bytes_ = 0;
};

/// "2 s", "150 ms"
std::string duration_text(std::chrono::milliseconds time);

}  // namespace hive::transport
