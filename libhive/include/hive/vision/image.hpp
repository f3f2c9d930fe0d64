// Converts between bodies of events and OpenCV images. Input is checked before it is decoded.
#pragma once

#include <hive/event.hpp>

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <string>

namespace hive::vision {

/// Limits of an image. Beyond them is Errc::too_large, checked without decoding.
struct DecodeLimits {
    std::int64_t pixels = 40'000'000;
    int scans = 100;  ///< of one JPEG
    /// Pixels times scans of one JPEG: the cost of decoding a progressive image. 16 scans of the largest image.
    std::int64_t pixel_scans = 640'000'000;
    /// Accept image/raw of gray16? Most vision code works on 8 bits and would misread it, so it is refused
    /// (Errc::unsupported) by default. 16 bit colour and 32 bit floats are always refused.
    bool sixteen_bits = false;
};

/// The media types that decode() supports, for inputs that accept images.
inline constexpr const char* image_types = "image/jpeg,image/png,image/raw";

/// The image in `body`: 8 bit BGR for image/jpeg and image/png (turned upright as EXIF says, exactly what cv::imdecode
/// gives), as declared for image/raw (then `header` has "width", "height", "pixel_format" of "bgr8", "gray8", "gray16"
/// or "bgra8", which becomes bgr8, and optionally "stride", the bytes from one row to the next). The caller owns the
/// pixels. Only the declared type is tried. A truncated or damaged image is refused, never returned in part.
/// @throws Error  malformed, too_large, or unsupported (another type, or a kind of JPEG that no camera produces:
///                arithmetic, lossless, 12 bit)
cv::Mat decode(const Body& body, const std::string& type, const DecodeLimits& limits = {},
               const Json& header = Json::object());

/// The image of an event. If its header declares "width" and "height", an image of more pixels is Errc::malformed.
cv::Mat decode(const Event& event, const DecodeLimits& limits = {});

/// As decode(), but the pixels of image/raw are not copied, except bgra8: the result is read-only and valid while
/// `event.body` lives.
cv::Mat view(const Event& event, const DecodeLimits& limits = {});

/// The size of the image (upright), without decoding it; with the checks and errors of decode() that precede decoding.
cv::Size size_of(const Body& body, const std::string& type, const DecodeLimits& limits = {},
                 const Json& header = Json::object());

/// @param image  8 bit with 1 or 3 (BGR) channels, or 16 bit grey, of which a JPEG keeps the upper eight
/// @param quality  1 to 100; colour is subsampled 4:2:0
/// @throws Error  too_large (a side has at most 65500 pixels, of a PNG 1000000), invalid_argument (pixels of another
/// kind),
///                failed
Body encode_jpeg(const cv::Mat& image, int quality);
Body encode_png(const cv::Mat& image);
/// The pixels themselves, not copied if they are contiguous: do not draw on `image` afterwards. If they are those of
/// a loan (loans.hpp), the body is that loan; only a part of a loan is copied.
Body encode_raw(const cv::Mat& image);
/// Adds the fields of image/raw to `header`: "width", "height", "pixel_format", "stride", for the layout of encode_raw.
Json raw_header(const cv::Mat& image, Json header = Json::object());

/// The form in which pixels of one size are emitted: image/raw, or if they exceed the maximum size of a body,
/// image/jpeg (16 bit: image/png). The encoder converts it for each connection (encoder.hpp).
struct PlainForm {
    std::string type;
    Json header;  ///< "width", "height", and the other fields of image/raw

    [[nodiscard]] Body body(const cv::Mat& image) const;
};
/// @param channels  1 or 3 (BGR)
/// @param bits      of each: 8, or 16 for one channel
PlainForm plain_form(cv::Size size, int channels, int bits = 8);

}  // namespace hive::vision
