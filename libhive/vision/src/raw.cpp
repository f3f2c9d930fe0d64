// image/raw in both directions. All products are made in 64 bits of numbers that were bounded first.
#include "raw.hpp"

#include <hive/error.hpp>
#include <hive/vision/loans.hpp>

namespace hive::vision {
namespace {

constexpr std::int64_t longest_side = 1 << 20;
constexpr std::int64_t longest_row = std::int64_t{1} << 31;
constexpr std::int64_t most_bytes = 64 << 20;  ///< of a body (SPEC.md, section 3)
constexpr int quality_of_large_pictures = 90;

struct Layout {
    int width, height, channels;
    std::int64_t stride;
};

Layout layout(const Body& body, const Json& header, const DecodeLimits& limits)
{
    const Fields fields(header, "image/raw");
    const std::string format = fields.text("pixel_format");
    if (format != "bgr8" && format != "gray8")
        throw Error(Errc::malformed, "image/raw: pixel_format is " + in_quotes(format) + ", neither bgr8 nor gray8");
    const int channels = format == "bgr8" ? 3 : 1;
    const std::int64_t width = fields.integer("width", 1, longest_side);
    const std::int64_t height = fields.integer("height", 1, longest_side);
    const std::int64_t stride = fields.integer_or("stride", width * channels, longest_row, width * channels);
    if (width * height > limits.pixels)
        throw Error(Errc::too_large,
                    "image/raw: " + std::to_string(width) + "x" + std::to_string(height) + " pixels are too many");
    if (static_cast<std::uint64_t>(stride * height) != body.size())
        throw Error(Errc::malformed, "image/raw: the header asks for " + std::to_string(stride * height)
                                         + " bytes, the body has " + std::to_string(body.size()));
    return {static_cast<int>(width), static_cast<int>(height), channels, stride};
}

Json raw_fields(cv::Size size, int channels)
{
    return {{"width", size.width},
            {"height", size.height},
            {"pixel_format", channels == 3 ? "bgr8" : "gray8"},
            {"stride", size.width * channels}};
}

}  // namespace

cv::Mat raw_view(const Body& body, const Json& header, const DecodeLimits& limits)
{
    const Layout raw = layout(body, header, limits);
    auto* pixels =
        const_cast<unsigned char*>(body.data());  // cv::Mat knows no const pixels; the promise is in the header
    return {raw.height, raw.width, CV_8UC(raw.channels), pixels, static_cast<std::size_t>(raw.stride)};
}

cv::Size raw_size(const Body& body, const Json& header, const DecodeLimits& limits)
{
    const Layout raw = layout(body, header, limits);
    return {raw.width, raw.height};
}

Json raw_header(const cv::Mat& picture, Json header)
{
    if (picture.type() != CV_8UC3 && picture.type() != CV_8UC1)
        throw Error(Errc::invalid_argument, "image/raw takes 8 bit pictures of 1 or 3 channels");
    header.update(raw_fields(picture.size(), picture.channels()));
    return header;
}

Body encode_raw(const cv::Mat& picture)
{
    raw_header(picture);  // refuses what raw pictures cannot be
    const Loan* loan = LoanAllocator::loan_of(picture);
    if (loan && picture.isContinuous() && picture.data == loan->data())
        return Loan(*loan).body(picture.total() * picture.elemSize());
    // Of a loan a part is copied too: the body may outlive the allocator.
    auto owner = std::make_shared<const cv::Mat>(picture.isContinuous() && !loan ? picture : picture.clone());
    const std::span pixels(owner->data, owner->total() * owner->elemSize());
    return {std::as_bytes(pixels), std::move(owner)};
}

PlainForm plain_form(cv::Size size, int channels)
{
    if (std::int64_t{size.width} * size.height * channels <= most_bytes)
        return {"image/raw", raw_fields(size, channels)};
    return {"image/jpeg", {{"width", size.width}, {"height", size.height}}};
}

Body PlainForm::body(const cv::Mat& picture) const
{
    return type == "image/raw" ? encode_raw(picture) : encode_jpeg(picture, quality_of_large_pictures);
}

}  // namespace hive::vision
