// A thread for one camera: connects, applies settings, fetches images, and reconnects.
#pragma once

#include "camera.hpp"
#include "retry_policy.hpp"

#include <capture_thread.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace axis {

enum class Pace {
    live,   ///< the camera's own: its stream
    demand  ///< one image for each ask()
};

/// Of a whole image, px.
struct Size {
    int width = 0, height = 0;
};

/// Whole and checked.
struct Frame {
    std::shared_ptr<const std::string> jpeg;
    Size size;
    std::int64_t index = 0;  ///< of this link, from 0
    std::chrono::system_clock::time_point captured{};
};

struct LinkSettings {
    Access access;
    std::string credentials_path;  ///< polled while the password is wrong; a file that is only touched
                                   ///< counts as new
    Pace pace = Pace::live;
    Parameters wanted;  ///< applied at each connection
};

/// Callbacks to the owner, called on the link's thread and never after the link is destroyed, except `measure`.
struct LinkHooks {
    std::function<void()> notice;                     ///< a new image or condition
    std::function<void(const std::string&)> log;      ///< a line for the log
    std::function<Size(const std::string&)> measure;  ///< the size of a complete JPEG; throws for any other
};

/// For one thread (the drone's); the link's own thread uses the network.
class CameraLink {
public:
    /// A thread stuck in name resolution ends later by itself.
    CameraLink(LinkSettings settings, LinkHooks hooks);

    /// The newest image not taken yet.
    std::optional<Frame> take();
    /// Pace::demand: requests one image. A further request before it has arrived has no effect.
    void ask();
    /// The new configuration of the camera, which the caller has already applied.
    void wanted(const Parameters& wanted);
    /// Restarts the stream: a camera does not change the size of a running one.
    void restart();
    /// Retries a password that is no longer tried, once, after reading the file of credentials again.
    void once_more();
    /// The password was refused at the last attempt: further attempts elsewhere would help to lock its user out.
    [[nodiscard]] bool login_refused() const;
    [[nodiscard]] std::string condition() const;

private:
    class Work;
    std::shared_ptr<Work> work_;
    capture::CaptureThread thread_;
};

}  // namespace axis
