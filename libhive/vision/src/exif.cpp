// Reads one tag of EXIF (a TIFF header and its first directory, CIPA DC-008 section 4.6), and rotates images by it.
#include "exif.hpp"

#include <opencv2/core.hpp>

#include <algorithm>
#include <string_view>

namespace hive::vision {
namespace {

/// Numbers of a TIFF structure in its byte order; reading outside gives 0.
struct Tiff {
    std::span<const std::uint8_t> bytes;
    bool big_endian;

    [[nodiscard]] std::uint32_t number(std::size_t at, std::size_t width) const noexcept
    {
        if (at > bytes.size() || width > bytes.size() - at)
            return 0;
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < width; ++i)
            value = value << 8 | bytes[at + (big_endian ? i : width - 1 - i)];
        return value;
    }
};

}  // namespace

int exif_orientation(std::span<const std::uint8_t> app1) noexcept
{
    constexpr std::string_view mark{"Exif\0\0", 6};
    if (app1.size() < mark.size() + 8
        || !std::ranges::equal(mark, app1.first(mark.size()), {}, [](char c) { return std::uint8_t(c); }))
        return 1;
    const auto inside = app1.subspan(mark.size());
    const Tiff tiff{inside, inside[0] == 'M'};
    const std::size_t directory = tiff.number(4, 4);
    const std::size_t entries = tiff.number(directory, 2);
    for (std::size_t entry = 0; entry < entries; ++entry) {
        const std::size_t at = directory + 2 + entry * 12;
        if (tiff.number(at, 2) != 0x0112)
            continue;
        const auto orientation = static_cast<int>(tiff.number(at + 8, 2));
        return orientation >= 1 && orientation <= 8 ? orientation : 1;
    }
    return 1;
}

cv::Mat upright(const cv::Mat& image, int orientation)
{
    enum { horizontal = 1, vertical = 0, both = -1 };
    cv::Mat turned = image;
    if (lies_on_its_side(orientation))
        cv::transpose(image, turned);
    switch (orientation) {
    case 2:
    case 6: cv::flip(turned, turned, horizontal); break;
    case 3:
    case 7: cv::flip(turned, turned, both); break;
    case 4:
    case 8: cv::flip(turned, turned, vertical); break;
    default: break;
    }
    return turned;
}

}  // namespace hive::vision
