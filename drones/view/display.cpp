// Uses Xlib alone, because its header defines words that others use as names.
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

}  // namespace view
