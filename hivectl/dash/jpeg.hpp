// Makes an image small enough for a box on a page.
#pragma once

#include <hive/event.hpp>

#include <string>
#include <vector>

namespace hivectl::dash {

struct Image {
    std::string type{};  ///< "image/jpeg"; that of the event if it is passed on as it is
    std::vector<unsigned char> bytes{};
};

/// A JPEG that is at least `width` pixels wide and less than twice that, if the image is not smaller. A JPEG that is
/// small enough, and what browsers show besides, is passed on as it is.
/// Throws Errc::malformed, Errc::unsupported and Errc::too_large.
Image image_for_page(const hive::Event& event, int width);

}  // namespace hivectl::dash
