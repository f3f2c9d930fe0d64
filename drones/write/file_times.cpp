// Keeps the distances between images of one clock.
#include "file_times.hpp"

namespace writing {

std::chrono::microseconds FileTimes::next(const Moment& moment)
{
    constexpr std::int64_t longest_us = 60'000'000;
    if (last_) {
        const auto distance = moment.time_us - last_->time_us;
        const bool continues = moment.clock == last_->clock && distance > 0 && distance <= longest_us;
        const auto usual = moment.fps > 0 ? static_cast<std::int64_t>(1e6 / moment.fps) : distance_us_;
        distance_us_ = continues ? distance : usual > 0 ? usual : 40'000;
        file_us_ += distance_us_;
    }
    last_ = moment;
    return std::chrono::microseconds(file_us_);
}

}  // namespace writing
