// Uses Xlib in a file of its own, because its header defines macros with common names.
#include "display.hpp"

#include <X11/Xlib.h>

namespace view {

bool has_display()
{
    Display* display = XOpenDisplay(nullptr);
    if (display)
        XCloseDisplay(display);
    return display != nullptr;
}

std::optional<cv::Size> room_for_window()
{
    Display* display = XOpenDisplay(nullptr);
    if (!display)
        return std::nullopt;
    const int screen = DefaultScreen(display);
    const cv::Size whole(DisplayWidth(display, screen), DisplayHeight(display, screen));
    XCloseDisplay(display);
    return cv::Size(whole.width * 95 / 100, whole.height * 88 / 100);
}

}  // namespace view
