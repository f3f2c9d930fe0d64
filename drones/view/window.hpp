// A window that shows the newest picture in its own size.
#pragma once

#include "exchange.hpp"

#include <atomic>
#include <functional>
#include <thread>

namespace view {

/// A thread of its own, which opens the window with the first picture. One in a process, for as long as that shows
/// windows: the toolkits want every call from the same thread. Needs has_display().
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
    /// There is a new picture. From any thread.
    void wake();

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
    std::thread thread_;
};

}  // namespace view
