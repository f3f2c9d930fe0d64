// Estimates the offset of another machine's wall clock and the round-trip time to it.
#pragma once

#include <hive/event/clock.hpp>

#include <cstdint>
#include <deque>

namespace hive::event {

/// Pure logic. Of the last answers with the peer's time, the one with the shortest round trip counts: it was not
/// delayed, so the peer read its clock in the middle of it.
class PeerClock {
public:
    /// @param wall_us  the local wall clock at the request
    /// @param peer_us  the peer's wall clock in its answer
    void answered(Clock::time_point asked, Clock::time_point answered, std::int64_t wall_us, std::int64_t peer_us);

    [[nodiscard]] bool known() const noexcept { return !samples_.empty(); }
    /// The peer's wall clock minus the local one; 0 while unknown.
    [[nodiscard]] std::int64_t offset_us() const noexcept;
    [[nodiscard]] std::int64_t round_trip_us() const noexcept;
    /// When the next question is due: soon at first, then every 2 s.
    [[nodiscard]] Clock::time_point due() const noexcept;

private:
    struct Sample {
        std::int64_t round_trip_us, offset_us;
    };
    [[nodiscard]] const Sample* best() const noexcept;

    std::deque<Sample> samples_;
    Clock::time_point last_{};
};

}  // namespace hive::event
