// Computes when the next image is due. The schedule is absolute, so that small delays do not add up.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace camera {

/// A value type with no clock of its own: the caller passes the time.
class Schedule {
public:
    using Clock = std::chrono::steady_clock;

    /// @param fps  frames per second; 0 or less: always due
    Schedule(double fps, Clock::time_point start) : fps_(fps), start_(start) {}

    [[nodiscard]] Clock::time_point due() const
    {
        if (fps_ <= 0)
            return start_;
        return start_
               + std::chrono::duration_cast<Clock::duration>(
                   std::chrono::duration<double>(static_cast<double>(count_) / fps_));
    }

    /// Advances the schedule by one. More than one missed place is not made up for: no burst follows a pause.
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

/// When the images of a video are due by their own times. No clock of its own, either.
class OwnTimes {
public:
    using Clock = Schedule::Clock;

    /// @param usual  duration of an image without a usable successor: the last of a round, or before a leap
    explicit OwnTimes(Clock::duration usual) : usual_(usual) {}

    /// Of the next image. No burst follows a pause.
    Clock::time_point due(std::chrono::microseconds time, Clock::time_point now)
    {
        constexpr std::chrono::minutes longest{1};
        if (time <= last_ || time - last_ > longest)
            start_ = std::max(now, next_) - time;
        else if (now > start_ + time + usual_)
            start_ = now - time;
        last_ = time;
        next_ = start_ + time + usual_;
        return start_ + time;
    }

    /// When the last image has been shown.
    [[nodiscard]] Clock::time_point next() const { return next_; }

private:
    Clock::duration usual_;
    Clock::time_point start_, next_;
    std::chrono::microseconds last_ =
        std::chrono::microseconds::max();  ///< the first time restarts, like one that goes back
};

}  // namespace camera
