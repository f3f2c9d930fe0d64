// Checks a JPEG by its markers alone (ITU-T T.81, annex B), before any memory is allocated for it. libjpeg would decode
// the coefficients for that: 1.3 to 8 ms instead of 0.02 ms for an image of 1920x1080, even if it is only forwarded;
// and libjpeg accepts a progressive image that ends between two scans as complete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace hive::vision {

struct JpegStructure {
    int width = 0, height = 0;  ///< as coded, before EXIF turns it
    int components = 0;         ///< 1: grey, 3: colour, 4: the inks of print
    int scans = 0;
    int orientation = 1;   ///< of EXIF, 1 to 8; 1 is upright
    std::size_t size = 0;  ///< bytes up to and including the end-of-image marker
};

/// Walks the markers from start to end of image. Throws Errc::malformed if they contradict each other or the end is
/// missing, Errc::unsupported except for 8 bit Huffman-coded images of one, three or four components, and
/// Errc::too_large at more than `max_scans` scans.
JpegStructure jpeg_structure(std::span<const std::uint8_t> bytes, int max_scans);

}  // namespace hive::vision
