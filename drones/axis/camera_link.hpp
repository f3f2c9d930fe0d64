// A thread that keeps in touch with one camera: connects, applies settings, fetches pictures, tries again when it is
// lost.
#pragma once

#include "camera.hpp"
#include "lifeline.hpp"

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
    demand  ///< one picture for each ask()
};

/// Of a whole picture, px.
struct Size {
    int width = 0, height = 0;
};

/// Whole and checked.
struct Picture {
    std::shared_ptr<const std::string> jpeg;
    Size size;
    std::int64_t index = 0;  ///< of this link, from 0
    std::chrono::system_clock::time_point captured{};
};

struct LinkSettings {
    Access access;
    std::string credentials_path;  ///< looked at again while the password is wrong; a file that is only written again
                                   ///< counts as new
    Pace pace = Pace::live;
    Parameters wanted;  ///< applied whenever the camera has been found
};

/// What the link tells its owner, each called from the link's thread and never after the link is destroyed; `measure`
/// may be.
struct LinkHooks {
    std::function<void()> notice;                 ///< there is a picture, or another condition
    std::function<void(const std::string&)> log;  ///< worth a line in the log
    std::function<Size(const std::string&)>
        measure;  ///< the size of a whole JPEG; throws saying what is wrong with any other
};

/// For one thread (the drone's); the network is met on the link's own.
class CameraLink {
public:
    /// Its thread may be stuck in the resolution of a name; then it ends by itself.
    CameraLink(LinkSettings settings, LinkHooks hooks);

    /// The newest picture that was not yet taken.
    std::optional<Picture> take();
    /// Pace::demand: one more picture, please. Asking again before it has come changes nothing.
    void ask();
    /// What the camera is to be from now on, which somebody else has told it.
    void wanted(const Parameters& wanted);
    /// Begins the stream anew: a camera gives a running stream no other size.
    void restart();
    /// A password that is tried no more is tried once more; the file of credentials is read first.
    void once_more();
    /// The password was refused when it was last tried: whoever tries it elsewhere helps to lock its user out.
    [[nodiscard]] bool login_refused() const;
    [[nodiscard]] std::string condition() const;

private:
    class Work;
    std::shared_ptr<Work> work_;
    capture::CaptureThread thread_;
};

}  // namespace axis
