// Checks for a display that can open a window, and the maximum size of the window.
#pragma once

#include <opencv2/core/types.hpp>

#include <optional>

namespace view {

/// Queries the X server of DISPLAY; the toolkits of OpenCV would exit the process on failure.
bool has_display();

/// The largest window that such a display can show with its frame and a panel, px; nothing without a display.
std::optional<cv::Size> room_for_window();

}  // namespace view
