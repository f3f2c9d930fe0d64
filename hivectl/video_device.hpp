// What a V4L2 camera says of itself, asked of its driver.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hivectl {

/// Asks a driver as ioctl does: fills in what `about` points to. False: there is no answer, or no further one.
using AskDriver = std::function<bool(unsigned long request, void* about)>;

/// Pictures that a camera can give.
struct VideoMode {
    std::string format;         ///< four letters: "MJPG"
    std::string size;           ///< "1280x720", or "160x120 to 1920x1080" where any between them can be had
    std::vector<double> rates;  ///< pictures a second; where any can be had between two, these

    bool operator==(const VideoMode&) const = default;
};

struct VideoDevice {
    std::string name, driver;
    std::vector<VideoMode> modes;
};

/// Nothing if it takes no pictures: cameras have further devices for other data. What a driver enumerates without end
/// is cut off.
std::optional<VideoDevice> video_device(const AskDriver& ask);

/// "30 15 7.5"
std::string rates_text(const std::vector<double>& rates);

}  // namespace hivectl
