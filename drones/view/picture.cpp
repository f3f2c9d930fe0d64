// Work that is done at the first look, and never again.
#include "picture.hpp"

#include <opencv2/imgcodecs.hpp>

namespace view {
namespace {

Jpeg encode(const cv::Mat& picture, int quality)
{
    auto bytes = std::make_shared<std::vector<unsigned char>>();
    cv::imencode(".jpg", picture, *bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
    return bytes;
}

}  // namespace

std::shared_ptr<const Picture> Picture::of_notice(const std::string& text)
{
    return std::make_shared<Picture>(Origin{}, Content{[text] { return notice(text); }, nullptr}, Look{.overlay = false});
}

const cv::Mat& Picture::shown() const
{
    std::call_once(drawn_once_, [this] { drawn_ = make_shown(); });
    return drawn_;
}

const Jpeg& Picture::jpeg() const
{
    std::call_once(encoded_once_, [this] { encoded_ = make_jpeg(); });
    return encoded_;
}

/// What damaged pictures do to a viewer: it says so in their place.
cv::Mat Picture::make_shown() const
try {
    const cv::Mat pixels = content_.pixels();
    return look_.overlay ? with_caption(pixels, caption(origin_, std::chrono::system_clock::now())) : pixels;
} catch (const std::exception& error) {
    return notice(error.what());
}

/// A picture whose sides are longer than a JPEG's may be cannot be encoded.
Jpeg Picture::make_jpeg() const
try {
    return content_.jpeg && !look_.overlay ? content_.jpeg : encode(shown(), look_.quality);
} catch (const std::exception& error) {
    return encode(notice(error.what()), look_.quality);
}

}  // namespace view
