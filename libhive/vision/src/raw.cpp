// Reads and writes image/raw. All products are computed in 64 bits from bounded numbers.
#include "raw.hpp"

#include <hive/error.hpp>
#include <hive/vision/loans.hpp>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>

namespace hive::vision {
namespace {

constexpr std::int64_t longest_side = 1 << 20;
constexpr std::int64_t longest_row = std::int64_t{1} << 31;
constexpr std::int64_t max_bytes = 64 << 20;  ///< of a body (SPEC.md, section 3)
constexpr int quality_of_large_images = 90;

/// OpenCV's type of a pixel, and its name.
struct PixelFormat {
    const char* word;
    int type;
};
constexpr std::array formats{
    PixelFormat{"bgr8", CV_8UC3},     PixelFormat{"gray8", CV_8UC1},   PixelFormat{"gray16", CV_16UC1},
    PixelFormat{"bgra8", CV_8UC4},    PixelFormat{"bgr16", CV_16UC3},  PixelFormat{"bgra16", CV_16UC4},
    PixelFormat{"gray32f", CV_32FC1}, PixelFormat{"bgr32f", CV_32FC3}, PixelFormat{"bgra32f", CV_32FC4}};

const PixelFormat& format_of(int type)
{
    const auto found = std::ranges::find(formats, type, &PixelFormat::type);
    if (found == formats.end())
        throw Error(Errc::invalid_argument, "image/raw takes 1, 3 or 4 channels of 8 bits, 16 bits or 32 bit floats");
    return *found;
}

const PixelFormat& format_named(const std::string& word)
{
    const auto found = std::ranges::find(formats, word, [](const PixelFormat& each) { return std::string(each.word); });
    if (found == formats.end())
        throw Error(Errc::malformed, "image/raw: pixel_format is " + in_quotes(word)
                                         + ", not gray, bgr or bgra with 8, 16 or 32f behind it");
    return *found;
}

/// Most code works on 8 bits and would misread other pixels.
void require_usable(const PixelFormat& format, const DecodeLimits& limits)
{
    const bool usable = CV_MAT_DEPTH(format.type) == CV_8U || (format.type == CV_16UC1 && limits.sixteen_bits);
    if (!usable)
        throw Error(Errc::unsupported,
                    std::string("this drone accepts only 8 bit images, not ") + format.word
                        + (CV_MAT_DEPTH(format.type) == CV_16U
                               ? "; let its sender emit the upper 8 bits of each value"
                               : "; let its sender scale the values to 0 to 255 and emit them as 8 bits"));
}

struct Layout {
    int width, height, type;
    std::int64_t stride;
};

Layout layout(const Body& body, const Json& header, const DecodeLimits& limits)
{
    const Fields fields(header, "image/raw");
    const PixelFormat& format = format_named(fields.text("pixel_format"));
    require_usable(format, limits);
    const std::int64_t pixel = CV_ELEM_SIZE(format.type);
    const std::int64_t width = fields.integer("width", 1, longest_side);
    const std::int64_t height = fields.integer("height", 1, longest_side);
    const std::int64_t stride = fields.integer_or("stride", width * pixel, longest_row, width * pixel);
    if (width * height > limits.pixels)
        throw Error(Errc::too_large,
                    "image/raw: " + std::to_string(width) + "x" + std::to_string(height) + " pixels are too many");
    if (static_cast<std::uint64_t>(stride * height) != body.size())
        throw Error(Errc::malformed, "image/raw: the header asks for " + std::to_string(stride * height)
                                         + " bytes, the body has " + std::to_string(body.size()));
    return {static_cast<int>(width), static_cast<int>(height), format.type, stride};
}

Json raw_fields(cv::Size size, int type)
{
    return {{"width", size.width},
            {"height", size.height},
            {"pixel_format", format_of(type).word},
            {"stride", size.width * CV_ELEM_SIZE(type)}};
}

}  // namespace

cv::Mat raw_view(const Body& body, const Json& header, const DecodeLimits& limits)
{
    const Layout raw = layout(body, header, limits);
    auto* pixels =
        const_cast<unsigned char*>(body.data());  // cv::Mat has no const pixels; the header promises read-only use
    const cv::Mat view(raw.height, raw.width, raw.type, pixels, static_cast<std::size_t>(raw.stride));
    if (raw.type != CV_8UC4)
        return view;
    cv::Mat opaque;
    cv::cvtColor(view, opaque, cv::COLOR_BGRA2BGR);
    return opaque;
}

cv::Size raw_size(const Body& body, const Json& header, const DecodeLimits& limits)
{
    const Layout raw = layout(body, header, limits);
    return {raw.width, raw.height};
}

Json raw_header(const cv::Mat& image, Json header)
{
    header.update(raw_fields(image.size(), image.type()));
    return header;
}

Body encode_raw(const cv::Mat& image)
{
    raw_header(image);  // refuses formats that image/raw does not have
    const Loan* loan = LoanAllocator::loan_of(image);
    if (loan && image.isContinuous() && image.data == loan->data())
        return Loan(*loan).body(image.total() * image.elemSize());
    // A part of a loan is also copied: the body may outlive the allocator.
    auto owner = std::make_shared<const cv::Mat>(image.isContinuous() && !loan ? image : image.clone());
    const std::span pixels(owner->data, owner->total() * owner->elemSize());
    return {std::as_bytes(pixels), std::move(owner)};
}

PlainForm plain_form(cv::Size size, int channels, int bits)
{
    const int type = CV_MAKETYPE(bits == 16 ? CV_16U : CV_8U, channels);
    if (std::int64_t{size.width} * size.height * CV_ELEM_SIZE(type) <= max_bytes)
        return {"image/raw", raw_fields(size, type)};
    return {bits == 16 ? "image/png" : "image/jpeg", {{"width", size.width}, {"height", size.height}}};
}

Body PlainForm::body(const cv::Mat& image) const
{
    if (type == "image/png")
        return encode_png(image);
    return type == "image/raw" ? encode_raw(image) : encode_jpeg(image, quality_of_large_images);
}

}  // namespace hive::vision
