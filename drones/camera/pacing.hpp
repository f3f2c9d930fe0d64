// Computes when the next picture is due. The schedule is absolute, so that small delays do not add up.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace camera {

/// A value type with no clock of its own: the caller says what time it is.
class Schedule {
public:
    using Clock = std::chrono::steady_clock;

    /// @param fps  pictures per second; 0 or less: always due
    Schedule(double fps, Clock::time_point start) : fps_(fps), start_(start) {}

    [[nodiscard]] Clock::time_point due() const
    {
        if (fps_ <= 0)
            return start_;
        return start_
               + std::chrono::duration_cast<Clock::duration>(
                   std::chrono::duration<double>(static_cast<double>(count_) / fps_));
    }

    /// Takes one place of the schedule. Places that were missed by more than one are not made up for: no burst follows
    /// a pause.
    void take(Clock::time_point now)
    {
        ++count_;
        if (fps_ > 0 && std::chrono::duration<double>(now - due()).count() > 1 / fps_) {
            start_ = now;
            count_ = 1;
        }
    }

private:
    double fps_;
    Clock::time_point start_;
    std::int64_t count_ = 0;
};

}  // namespace camera
