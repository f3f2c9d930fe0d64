#include "jpeg.hpp"

#include <hive/error.hpp>

#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <memory>

namespace hivectl::dash {
namespace {

struct Pixels {
    std::vector<unsigned char> bytes{};
    int width = 0, height = 0, channels = 0;
};

constexpr std::int64_t max_pixels = 40'000'000;

using Handle = std::unique_ptr<void, decltype(&tjDestroy)>;

[[noreturn]] void fail(const Handle& handle)
{
    throw hive::Error(hive::Errc::malformed, std::string("TurboJPEG: ") + tjGetErrorStr2(handle.get()));
}

int channels_of(const std::string& format)
{
    constexpr std::array<std::pair<std::string_view, int>, 3> formats{{{"gray8", 1}, {"bgr8", 3}, {"bgra8", 4}}};
    for (const auto& [name, channels] : formats)
        if (name == format)
            return channels;
    throw hive::Error(hive::Errc::unsupported, "pixels of the format " + hive::in_quotes(format) + " are not shown");
}

/// The mean of `factor` x `factor` pixels each.
Pixels shrunk(const unsigned char* from, std::size_t stride, Pixels shape, int factor)
{
    Pixels small{{}, std::max(1, shape.width / factor), std::max(1, shape.height / factor), shape.channels};
    factor = std::min({factor, shape.width, shape.height});
    const auto channels = static_cast<std::size_t>(shape.channels), side = static_cast<std::size_t>(factor);
    const auto row_bytes = static_cast<std::size_t>(small.width) * channels;
    small.bytes.resize(row_bytes * static_cast<std::size_t>(small.height));
    std::vector<unsigned> sums(row_bytes);
    for (std::size_t y = 0; y < static_cast<std::size_t>(small.height); ++y) {
        std::ranges::fill(sums, 0U);
        for (std::size_t line = 0; line < side; ++line) {
            const auto* pixel = from + (y * side + line) * stride;
            for (std::size_t x = 0; x < row_bytes; x += channels)
                for (std::size_t i = 0; i < side; ++i)
                    for (std::size_t c = 0; c < channels; ++c)
                        sums[x + c] += *pixel++;
        }
        for (std::size_t i = 0; i < row_bytes; ++i)
            small.bytes[y * row_bytes + i] = static_cast<unsigned char>(sums[i] / (side * side));
    }
    return small;
}

Pixels pixels_of_raw(const hive::Event& event, int width)
{
    constexpr std::int64_t max_side = 1 << 16;
    const hive::Fields fields(event.header, "the header of image/raw");
    const int channels = channels_of(fields.text("pixel_format"));
    const auto columns = fields.integer("width", 1, max_side), rows = fields.integer("height", 1, max_side);
    const auto stride = fields.integer_or("stride", columns * channels, 1 << 30, columns * channels);
    if (static_cast<std::int64_t>(event.body.size()) != stride * rows)
        throw hive::Error(hive::Errc::malformed, "the body of image/raw does not have the size in its header");
    const int factor = std::max(1, static_cast<int>(columns) / width);
    return shrunk(event.body.data(), static_cast<std::size_t>(stride),
                  {{}, static_cast<int>(columns), static_cast<int>(rows), channels}, factor);
}

/// Decodes at an eighth, a quarter or a half, which is faster than the full size. Nothing: it is small enough.
std::optional<Pixels> pixels_of_jpeg(const std::vector<unsigned char>& jpeg, int width)
{
    const Handle handle(tjInitDecompress(), tjDestroy);
    int columns = 0, rows = 0, sampling = 0, colours = 0;
    if (tjDecompressHeader3(handle.get(), jpeg.data(), jpeg.size(), &columns, &rows, &sampling, &colours) != 0)
        fail(handle);
    if (std::int64_t{columns} * rows > max_pixels)
        throw hive::Error(hive::Errc::too_large, "an image of more than 40 megapixels is not shown");
    int part = 1;
    while (part < 8 && columns / (part * 2) >= width)
        part *= 2;
    if (part == 1)
        return std::nullopt;
    const tjscalingfactor scale{1, part};
    Pixels pixels{{}, TJSCALED(columns, scale), TJSCALED(rows, scale), 3};
    pixels.bytes.resize(static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.height) * 3);
    if (tjDecompress2(handle.get(), jpeg.data(), jpeg.size(), pixels.bytes.data(), pixels.width, 0, pixels.height,
                      TJPF_BGR, TJFLAG_FASTDCT | TJFLAG_LIMITSCANS)
            != 0
        && tjGetErrorCode(handle.get()) == TJERR_FATAL)
        fail(handle);
    return pixels;
}

Image jpeg_of(const Pixels& pixels)
{
    constexpr int quality = 75;
    const Handle handle(tjInitCompress(), tjDestroy);
    const int format = pixels.channels == 1 ? TJPF_GRAY : pixels.channels == 3 ? TJPF_BGR : TJPF_BGRA;
    const int sampling = pixels.channels == 1 ? TJSAMP_GRAY : TJSAMP_420;
    Image image{"image/jpeg", std::vector<unsigned char>(tjBufSize(pixels.width, pixels.height, sampling))};
    auto* buffer = image.bytes.data();
    unsigned long size = image.bytes.size();
    if (tjCompress2(handle.get(), pixels.bytes.data(), pixels.width, 0, pixels.height, format, &buffer, &size, sampling,
                    quality, TJFLAG_FASTDCT | TJFLAG_NOREALLOC)
        != 0)
        fail(handle);
    image.bytes.resize(size);
    return image;
}

}  // namespace

Image image_for_page(const hive::Event& event, int width)
{
    if (event.type == "image/raw")
        return jpeg_of(pixels_of_raw(event, width));
    constexpr std::array<std::string_view, 5> shown{"image/jpeg", "image/png", "image/gif", "image/bmp", "image/webp"};
    if (std::ranges::find(shown, event.type) == shown.end())
        throw hive::Error(hive::Errc::unsupported, "browsers do not show " + hive::in_quotes(event.type));
    // Copied first: the sender could change bytes of shared memory while they are decoded.
    Image image{event.type, std::vector<unsigned char>(event.body.data(), event.body.data() + event.body.size())};
    if (event.type == "image/jpeg")
        if (const auto pixels = pixels_of_jpeg(image.bytes, width))
            return jpeg_of(*pixels);
    return image;
}

}  // namespace hivectl::dash
