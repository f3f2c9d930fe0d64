// How far the wall clock of another machine is from the own one, and how long a packet takes there and back.
#pragma once

#include <hive/event/clock.hpp>

#include <cstdint>
#include <deque>

namespace hive::event {

/// Knows no socket and asks no clock. Of the last questions whose answer told the peer's time, the one with the
/// shortest round trip counts: nothing held it up, so the middle of its way is when the peer read its clock.
class PeerClock {
public:
    /// @param wall_us  the own wall clock when it was asked
    /// @param peer_us  the peer's wall clock in its answer
    void answered(Clock::time_point asked, Clock::time_point answered, std::int64_t wall_us, std::int64_t peer_us);

    [[nodiscard]] bool known() const noexcept { return !samples_.empty(); }
    /// The peer's wall clock minus the own one; 0 as long as it is not known.
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
