// A thread that reads a source at its pace and keeps the newest picture for the drone.
#pragma once

#include "source.hpp"

#include <capture_thread.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace camera {

/// Opens the source, and again with growing pauses when it is lost; how it goes is told by condition(). All functions
/// are for one thread (the drone's); opening and reading happen on the capture's own.
class Capture {
public:
    using Opener = std::function<std::unique_ptr<Source>()>;
    enum class AtEnd { stop, open_again };  ///< of a file; of a camera, whose end is a loss

    /// @param fps     pictures per second; 0: as the source has it, or 30 if it has no rate
    /// @param notice  called from the capture's thread when there is news; never after the capture is destroyed
    Capture(Opener open, double fps, AtEnd at_end, std::function<void()> notice);

    /// The newest picture that was not yet taken.
    std::optional<Frame> take();
    /// What is to be reported and was not taken yet: pictures that cannot be read, what was left out.
    std::vector<std::string> problems();
    /// Why the end came too early; empty if it did not.
    [[nodiscard]] std::string cut_short() const;
    /// Has a file come to its end? What take() gives after that is its last picture.
    [[nodiscard]] bool ended() const;
    /// Empty when pictures come; otherwise what is wrong: "stalled", "end of source", or why it does not open.
    [[nodiscard]] std::string
    condition(std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now()) const;

private:
    class Work;
    std::shared_ptr<Work> work_;
    capture::CaptureThread thread_;
};

}  // namespace camera
