// A window that shows the newest image, in its own size where the screen is large enough.
#pragma once

#include "exchange.hpp"

#include <atomic>
#include <functional>
#include <optional>
#include <thread>

namespace view {

/// Its own thread, which opens the window with the first image. One per process as long as it shows windows: the
/// toolkits require every call on the same thread. Needs has_display().
class Window {
public:
    /// @param closed    called on that thread when the user closes the window or presses q or Escape
    /// @param exchange  outlives the window
    Window(const Exchange& exchange, std::function<void()> closed);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// Shows or hides it. From any thread.
    void visible(bool yes);
    /// Signals a new image. From any thread.
    void wake();

    /// The image, or a smaller one of the same aspect ratio that fits into the room. (For tests.)
    static cv::Mat fitted(const cv::Mat& image, const std::optional<cv::Size>& room);

private:
    void run(const std::function<void()>& closed);
    void show(const Exchange::Newest& newest);
    bool ended_by_user();

    const Exchange& exchange_;
    std::atomic<bool> visible_{true}, ending_{false};
    std::atomic<unsigned> wakes_{0};
    std::uint64_t version_ = 0;
    std::string title_;
    bool open_ = false;
    std::optional<cv::Size> room_;  ///< for the window
    std::thread thread_;
};

}  // namespace view
