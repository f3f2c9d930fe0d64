// Finds out whether there is a display on which a window can be opened, and how large that may be.
#pragma once

#include <opencv2/core/types.hpp>

#include <optional>

namespace view {

/// Asks the X server that DISPLAY names; the toolkits under OpenCV end the process instead of saying no.
bool has_display();

/// The largest window that such a display can show with its frame and a bar beside it, px; nothing without a display.
std::optional<cv::Size> room_for_window();

}  // namespace view
