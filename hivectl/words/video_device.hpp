// Queries the driver of a V4L2 camera for its modes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hivectl {

/// Queries a driver like ioctl: fills in what `about` points to. False: no answer, or no further one.
using AskDriver = std::function<bool(unsigned long request, void* about)>;

/// One format and size of a camera.
struct VideoMode {
    std::string format;         ///< four letters: "MJPG"
    std::string size;           ///< "1280x720", or "160x120 to 1920x1080" for a range
    std::vector<double> rates;  ///< frames per second; for a range, its limits

    bool operator==(const VideoMode&) const = default;
};

struct VideoDevice {
    std::string name, driver;
    std::vector<VideoMode> modes;
};

/// Nothing if it captures no images: cameras have further devices for other data. Endless enumerations of a driver are
/// cut off.
std::optional<VideoDevice> video_device(const AskDriver& ask);

/// "30 15 7.5"
std::string rates_text(const std::vector<double>& rates);

}  // namespace hivectl
