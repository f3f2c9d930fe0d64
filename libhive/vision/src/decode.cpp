// Bodies to pictures: one decoder per declared type, chosen by the declaration and never by sniffing.
#include "exif.hpp"
#include "jpeg_structure.hpp"
#include "raw.hpp"

#include <hive/error.hpp>

#include <opencv2/imgcodecs.hpp>
#include <turbojpeg.h>

#include <algorithm>
#include <array>

namespace hive::vision {
namespace {

std::span<const std::uint8_t> bytes_of(const Body& body) { return {body.data(), body.size()}; }

void check_pixels(std::int64_t width, std::int64_t height, const DecodeLimits& limits, const char* format)
{
    if (width * height > limits.pixels)
        throw Error(Errc::too_large, std::string(format) + ": " + std::to_string(width) + "x" + std::to_string(height)
                                         + " pixels are over the limit of " + std::to_string(limits.pixels));
}

JpegStructure checked_jpeg(const Body& body, const DecodeLimits& limits)
{
    const JpegStructure jpeg = jpeg_structure(bytes_of(body), limits.scans);
    check_pixels(jpeg.width, jpeg.height, limits, "JPEG");
    if (std::int64_t{jpeg.width} * jpeg.height * jpeg.scans > limits.pixel_scans)
        throw Error(Errc::too_large,
                    "JPEG: " + std::to_string(jpeg.scans) + " scans are too many for so large a picture");
    return jpeg;
}

/// A warning of the decoder (data missing, data left over) means that pixels were invented: it is an error here.
cv::Mat decode_jpeg(const Body& body, const DecodeLimits& limits)
{
    const JpegStructure jpeg = checked_jpeg(body, limits);
    const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
    if (!decoder)
        throw Error(Errc::failed, "the JPEG decoder could not be made");
    cv::Mat picture(jpeg.height, jpeg.width, CV_8UC3);
    if (tjDecompress2(decoder.get(), body.data(), static_cast<unsigned long>(jpeg.size), picture.data, jpeg.width,
                      static_cast<int>(picture.step), jpeg.height, TJPF_BGR, TJFLAG_STOPONWARNING)
        != 0)
        throw Error(Errc::malformed, std::string("JPEG: ") + tjGetErrorStr2(decoder.get()));
    return upright(picture, jpeg.orientation);
}

/// Reads the first chunk, which must be IHDR (W3C PNG, 11.2.2): the size without decoding.
cv::Size png_size(const Body& body, const DecodeLimits& limits)
{
    constexpr std::array<std::uint8_t, 16> beginning{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n',
                                                     0,    0,   0,   13,  'I',  'H',  'D',  'R'};
    const auto bytes = bytes_of(body);
    if (bytes.size() < 33 || !std::ranges::equal(beginning, bytes.first(beginning.size())))
        throw Error(Errc::malformed, "PNG: does not begin with a signature and an image header");
    const auto number = [&](std::size_t at) {
        return std::int64_t{bytes[at]} << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 | bytes[at + 3];
    };
    const std::int64_t width = number(16), height = number(20), most = 0x7FFFFFFF;
    if (width < 1 || height < 1 || width > most || height > most)
        throw Error(Errc::malformed, "PNG: has no width or no height");
    check_pixels(width, height, limits, "PNG");
    return {static_cast<int>(width), static_cast<int>(height)};
}

cv::Mat decode_png(const Body& body, const DecodeLimits& limits)
{
    const cv::Size size = png_size(body, limits);
    const cv::Mat encoded(1, static_cast<int>(body.size()), CV_8UC1, const_cast<unsigned char*>(body.data()));
    cv::Mat picture;
    try {
        picture = cv::imdecode(encoded, cv::IMREAD_COLOR);
    } catch (const cv::Exception& problem) {
        throw Error(Errc::malformed, "PNG: " + problem.err);
    }
    if (picture.empty() || picture.total() != std::size_t(size.width) * std::size_t(size.height))
        throw Error(Errc::malformed, "PNG: damaged or cut short");
    return picture;
}

[[noreturn]] void unknown_type(const std::string& type)
{
    throw Error(Errc::unsupported,
                "pictures of type " + in_quotes(type) + " are not supported; " + image_types + " are");
}

/// What is checked before it is decoded must not change in between.
Body unchanging(const Body& body)
{
    return body.foreign() ? Body(std::vector(body.data(), body.data() + body.size())) : body;
}

cv::Mat picture_of(const Body& body, const std::string& type, const DecodeLimits& limits, const Json& header)
{
    if (type == "image/jpeg")
        return decode_jpeg(body, limits);
    if (type == "image/png")
        return decode_png(body, limits);
    if (type == "image/raw")
        return raw_view(body, header, limits);
    unknown_type(type);
}

}  // namespace

cv::Mat decode(const Body& body, const std::string& type, const DecodeLimits& limits, const Json& header)
{
    cv::Mat picture = picture_of(type == "image/raw" ? body : unchanging(body), type, limits, header);
    return type == "image/raw" ? picture.clone() : picture;
}

cv::Mat decode(const Event& event, const DecodeLimits& limits)
{
    cv::Mat picture = view(event, limits);
    return event.type == "image/raw" ? picture.clone() : picture;
}

cv::Mat view(const Event& event, const DecodeLimits& limits)
{
    const Json& header = event.header;
    const Body body = event.type == "image/raw" ? event.body : unchanging(event.body);
    const auto declares = [&](const char* key) { return header.contains(key) && header[key].is_number_integer(); };
    if (event.type != "image/raw" && declares("width") && declares("height")) {
        const Fields fields(header, event.type);
        const cv::Size size = size_of(body, event.type, limits);
        if (std::int64_t{size.width} * size.height
            > fields.integer("width", 1, 1 << 20) * fields.integer("height", 1, 1 << 20))
            throw Error(Errc::malformed, "the picture is larger than its header says");
    }
    return picture_of(body, event.type, limits, header);
}

cv::Size size_of(const Body& body, const std::string& type, const DecodeLimits& limits, const Json& header)
{
    if (type == "image/png")
        return png_size(body, limits);
    if (type == "image/raw")
        return raw_size(body, header, limits);
    if (type != "image/jpeg")
        unknown_type(type);
    const JpegStructure jpeg = checked_jpeg(body, limits);
    return lies_on_its_side(jpeg.orientation) ? cv::Size(jpeg.height, jpeg.width) : cv::Size(jpeg.width, jpeg.height);
}

}  // namespace hive::vision
