// Converts the times of images into increasing times in a file.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace writing {

/// The capture time of an image by its event.
struct Moment {
    std::string clock;         ///< the clock: a file, or a camera since its start; another one restarts
    std::int64_t time_us = 0;  ///< on that clock
    double fps = 0;            ///< of the source; 0: unknown
};

/// No clock of its own.
class FileTimes {
public:
    /// The time of the next image since the first. If the clock changes, goes back or jumps by more than a minute, the
    /// image follows the last one at the usual interval.
    std::chrono::microseconds next(const Moment& moment);

private:
    std::optional<Moment> last_;
    std::int64_t file_us_ = 0;      ///< of the last image
    std::int64_t distance_us_ = 0;  ///< between the last two
};

}  // namespace writing
