// Decodes bodies: one decoder per type, chosen by the declared type and never by sniffing.
#include "exif.hpp"
#include "jpeg_structure.hpp"
#include "png_pixels.hpp"
#include "raw.hpp"

#include <hive/error.hpp>

#include <opencv2/core.hpp>
#include <turbojpeg.h>

#include <algorithm>

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
                    "JPEG: " + std::to_string(jpeg.scans) + " scans are too many for an image of this size");
    return jpeg;
}

/// Converts CMYK to BGR as cv::imdecode does: the values are assumed inverted, as all programs write them.
cv::Mat in_colour(const cv::Mat& inks)
{
    cv::Mat image(inks.size(), CV_8UC3);
    for (int row = 0; row < inks.rows; ++row)
        std::transform(inks.ptr<cv::Vec4b>(row), inks.ptr<cv::Vec4b>(row) + inks.cols, image.ptr<cv::Vec3b>(row),
                       [](const cv::Vec4b& ink) {
                           const int black = ink[3];
                           const auto light = [black](int colour) {
                               return static_cast<std::uint8_t>(black - ((255 - colour) * black >> 8));
                           };
                           return cv::Vec3b(light(ink[2]), light(ink[1]), light(ink[0]));
                       });
    return image;
}

/// A warning of the decoder (data missing, data left over) means that pixels were invented: it is an error here.
cv::Mat decode_jpeg(const Body& body, const DecodeLimits& limits)
{
    const JpegStructure jpeg = checked_jpeg(body, limits);
    const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
    if (!decoder)
        throw Error(Errc::failed, "the JPEG decoder could not be created");
    const bool cmyk = jpeg.components == 4;
    const cv::Mat image(jpeg.height, jpeg.width, cmyk ? CV_8UC4 : CV_8UC3);
    if (tjDecompress2(decoder.get(), body.data(), static_cast<unsigned long>(jpeg.size), image.data, jpeg.width,
                      static_cast<int>(image.step), jpeg.height, cmyk ? TJPF_CMYK : TJPF_BGR, TJFLAG_STOPONWARNING)
        != 0)
        throw Error(Errc::malformed, std::string("JPEG: ") + tjGetErrorStr2(decoder.get()));
    return upright(cmyk ? in_colour(image) : image, jpeg.orientation);
}

PngSize checked_png(const Body& body, const DecodeLimits& limits)
{
    const PngSize size = png_size(bytes_of(body));
    check_pixels(size.width, size.height, limits, "PNG");
    return size;
}

cv::Mat decode_png(const Body& body, const DecodeLimits& limits)
{
    const PngSize size = checked_png(body, limits);
    cv::Mat image(static_cast<int>(size.height), static_cast<int>(size.width), CV_8UC3);
    const int orientation = read_png(bytes_of(body), image);
    return upright(image, orientation);
}

cv::Size size_of_png(const Body& body, const DecodeLimits& limits)
{
    const PngSize size = checked_png(body, limits);
    return {static_cast<int>(size.width), static_cast<int>(size.height)};
}

[[noreturn]] void unknown_type(const std::string& type)
{
    throw Error(Errc::unsupported, "images of type " + in_quotes(type) + " are not supported; " + image_types + " are");
}

/// The bytes must not change between check and decoding.
Body unchanging(const Body& body)
{
    return body.foreign() ? Body(std::vector(body.data(), body.data() + body.size())) : body;
}

cv::Mat image_of(const Body& body, const std::string& type, const DecodeLimits& limits, const Json& header)
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
    cv::Mat image = image_of(type == "image/raw" ? body : unchanging(body), type, limits, header);
    return type == "image/raw" ? image.clone() : image;
}

cv::Mat decode(const Event& event, const DecodeLimits& limits)
{
    cv::Mat image = view(event, limits);
    return event.type == "image/raw" ? image.clone() : image;
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
            throw Error(Errc::malformed, "the image is larger than its header says");
    }
    return image_of(body, event.type, limits, header);
}

cv::Size size_of(const Body& body, const std::string& type, const DecodeLimits& limits, const Json& header)
{
    if (type == "image/png")
        return size_of_png(body, limits);
    if (type == "image/raw")
        return raw_size(body, header, limits);
    if (type != "image/jpeg")
        unknown_type(type);
    const JpegStructure jpeg = checked_jpeg(body, limits);
    return lies_on_its_side(jpeg.orientation) ? cv::Size(jpeg.height, jpeg.width) : cv::Size(jpeg.width, jpeg.height);
}

}  // namespace hive::vision
