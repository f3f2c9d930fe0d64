// An image of a declared type, as it is and with the check sums of a PNG put right: it is decoded within the limits,
// or refused with one of three errors, and its size is known without decoding it. Input: one byte for the type, then
// the image.
#include "require.hpp"

#include <hive/error.hpp>
#include <hive/vision/image.hpp>

#include <opencv2/core.hpp>
#include <zlib.h>

#include <string>
#include <vector>

namespace {

using hive::fuzz::require;
namespace vision = hive::vision;
using Bytes = std::vector<unsigned char>;

constexpr vision::DecodeLimits limits{.pixels = 100'000, .scans = 20, .pixel_scans = 400'000, .sixteen_bits = true};

/// Nothing when the image is refused.
template <class Work>
auto unless_refused(Work work) -> decltype(work())
{
    try {
        return work();
    } catch (const hive::Error& error) {
        using enum hive::Errc;
        require(error.code() == malformed || error.code() == too_large || error.code() == unsupported,
                "an image is refused for what it is");
        require(!hive::to_text(hive::Json(error.what())).empty(), "a refusal can be printed");
        return {};
    }
}

void decode(const Bytes& bytes, const std::string& type)
{
    const hive::Body body(bytes);
    const auto size = unless_refused([&] { return vision::size_of(body, type, limits); });
    require(std::int64_t{size.width} * size.height <= limits.pixels, "a size is within the limit");
    const auto image = unless_refused([&] { return vision::decode(body, type, limits); });
    if (image.empty())
        return;
    require(image.size().area() == size.area(), "the size is known before");
    cv::sum(image);  // all of it can be read
}

std::size_t number_at(const Bytes& bytes, std::size_t at)
{
    return std::size_t{bytes[at]} << 24 | std::size_t{bytes[at + 1]} << 16 | std::size_t{bytes[at + 2]} << 8
           | bytes[at + 3];
}

/// A fuzzer does not guess those of its chunks.
Bytes with_right_sums(Bytes png)
{
    constexpr std::size_t signature = 8, around_data = 12;
    for (std::size_t at = signature; png.size() >= at + around_data;) {
        const std::size_t size = number_at(png, at);
        if (size > png.size() - at - around_data)
            break;
        const auto sum = ::crc32(0, png.data() + at + 4, static_cast<uInt>(size + 4));
        for (std::size_t i = 0; i < 4; ++i)
            png[at + 8 + size + i] = static_cast<unsigned char>(sum >> (24 - 8 * i));
        at += size + around_data;
    }
    return png;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    if (size == 0)
        return 0;
    const Bytes image(bytes + 1, bytes + size);
    if (bytes[0] % 2 == 0) {
        decode(image, "image/jpeg");
        return 0;
    }
    decode(image, "image/png");
    decode(with_right_sums(image), "image/png");
    return 0;
}
