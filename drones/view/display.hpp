// Finds out whether there is a display on which a window can be opened.
#pragma once

namespace view {

/// Asks the X server that DISPLAY names; the toolkits under OpenCV end the process instead of saying no.
bool has_display();

}  // namespace view
