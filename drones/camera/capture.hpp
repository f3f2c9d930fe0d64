// A thread that reads a source at its pace and keeps the newest image for the drone.
#pragma once

#include "source.hpp"

#include <capture_thread.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace camera {

/// Opens the source, and reopens it with growing pauses when it is lost; condition() has the state. All functions are
/// for one thread (the drone's); the capture's own thread opens and reads.
class Capture {
public:
    using Opener = std::function<std::unique_ptr<Source>()>;
    enum class AtEnd { stop, open_again };  ///< of a file; of a camera, whose end is a loss

    /// @param fps     frames per second; 0: as the source has it, or 30 if it has no rate
    /// @param notice  called from the capture's thread when there is news; never after the capture is destroyed
    /// @param opening  what condition() says while it is being opened; empty: nothing
    Capture(Opener open, double fps, AtEnd at_end, std::function<void()> notice, std::string opening = "");

    /// The newest image not taken yet.
    std::optional<Frame> take();
    /// Problems not taken yet: unreadable images, omitted files.
    std::vector<std::string> problems();
    /// Why the end came too early; empty if it did not.
    [[nodiscard]] std::string cut_short() const;
    /// Has it ended because a login was refused three times?
    [[nodiscard]] bool gave_up() const;
    /// Has a file ended? After that, take() returns its last image.
    [[nodiscard]] bool ended() const;
    /// Empty while images arrive; otherwise the problem: "stalled", "end of source", or why it does not open.
    [[nodiscard]] std::string
    condition(std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now()) const;

private:
    class Work;
    std::shared_ptr<Work> work_;
    capture::CaptureThread thread_;
};

}  // namespace camera
