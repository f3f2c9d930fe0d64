// Makes an image small enough for a box on a page.
#pragma once

#include <hive/event.hpp>

#include <string>
#include <vector>

namespace hivectl::dash {

struct Image {
    std::string type{};  ///< "image/jpeg"; that of the event if it is forwarded unchanged
    std::vector<unsigned char> bytes{};
};

/// A JPEG that is at least `width` pixels wide and less than twice that, if the image is not smaller. A JPEG that is
/// small enough, and other types that browsers show, are forwarded unchanged. Throws Errc::malformed, Errc::unsupported
/// and Errc::too_large.
Image image_for_page(const hive::Event& event, int width);

}  // namespace hivectl::dash
