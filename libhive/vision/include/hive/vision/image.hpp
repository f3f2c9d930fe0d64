// Between the bodies of events and OpenCV pictures: what comes in is checked before it is decoded.
#pragma once

#include <hive/event.hpp>

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <string>

namespace hive::vision {

/// What a picture may cost. Beyond it is Errc::too_large, found out without decoding.
struct DecodeLimits {
    std::int64_t pixels = 40'000'000;
    int scans = 100;  ///< of one JPEG
    /// Pixels times scans of one JPEG: what decoding a progressive picture costs. 16 scans of the largest picture.
    std::int64_t pixel_scans = 640'000'000;
    /// Are image/raw pictures of gray16 taken? Most code of vision works on 8 bits and would misread them, so that they
    /// are refused (Errc::unsupported) unless asked for. Colour of 16 bits and 32 bit floats are refused always.
    bool sixteen_bits = false;
};

/// The media types that decode() knows; what an input that takes pictures declares.
inline constexpr const char* image_types = "image/jpeg,image/png,image/raw";

/// The picture in `body`: 8 bit BGR for image/jpeg and image/png (turned upright as EXIF says, exactly what
/// cv::imdecode gives), as declared for image/raw (then `header` has "width", "height", "pixel_format" of "bgr8",
/// "gray8", "gray16" or "bgra8", which becomes bgr8, and optionally "stride", the bytes from one row to the next). The
/// caller owns the pixels. Only
/// the declared type is tried. A picture that is cut short or damaged is refused, never returned in part.
/// @throws Error  malformed, too_large, or unsupported (another type, or a kind of JPEG that no camera makes:
///                arithmetic, lossless, 12 bit)
cv::Mat decode(const Body& body, const std::string& type, const DecodeLimits& limits = {},
               const Json& header = Json::object());

/// The picture of an event. If its header declares "width" and "height", a picture of more pixels is Errc::malformed.
cv::Mat decode(const Event& event, const DecodeLimits& limits = {});

/// As decode(), but the pixels of image/raw are not copied, except bgra8: the result is read-only and valid while
/// `event.body` lives.
cv::Mat view(const Event& event, const DecodeLimits& limits = {});

/// The size of the picture (upright), without decoding it; the same checks and errors as before decoding.
cv::Size size_of(const Body& body, const std::string& type, const DecodeLimits& limits = {},
                 const Json& header = Json::object());

/// @param picture  8 bit with 1 or 3 (BGR) channels, or 16 bit grey, of which a JPEG keeps the upper eight
/// @param quality  1 to 100; colour is subsampled 4:2:0
/// @throws Error  too_large (a side has at most 65500 pixels, of a PNG 1000000), invalid_argument (pixels of another
/// kind),
///                failed
Body encode_jpeg(const cv::Mat& picture, int quality);
Body encode_png(const cv::Mat& picture);
/// The pixels themselves, not copied when they lie without gaps: do not draw on `picture` afterwards. When they are
/// those of a loan (loans.hpp), the body is that loan; only a part of one is copied.
Body encode_raw(const cv::Mat& picture);
/// `header` with the fields that image/raw needs: "width", "height", "pixel_format", "stride", as encode_raw lays them
/// out.
Json raw_header(const cv::Mat& picture, Json header = Json::object());

/// How pictures of one size are emitted when they are at hand as pixels: as image/raw, or when the pixels are more than
/// the body of an event may hold as image/jpeg, or as image/png where each has 16 bits. What connections want is the
/// encoder's business (encoder.hpp).
struct PlainForm {
    std::string type;
    Json header;  ///< "width", "height", and what image/raw needs beside them

    [[nodiscard]] Body body(const cv::Mat& picture) const;
};
/// @param channels  1 or 3 (BGR)
/// @param bits      of each: 8, or 16 where there is one channel
PlainForm plain_form(cv::Size size, int channels, int bits = 8);

}  // namespace hive::vision
