// Does each step on first use, and only once.
#include "image.hpp"

#include <hive/vision/image.hpp>

#include <exception>
#include <utility>

namespace view {
namespace {

Jpeg encode(const cv::Mat& image, int quality)
{
    const hive::Body jpeg = hive::vision::encode_jpeg(image, quality);
    return std::make_shared<std::vector<unsigned char>>(jpeg.data(), jpeg.data() + jpeg.size());
}

}  // namespace

/// The received image, decoded at most once, even if that fails.
class Image::Source {
public:
    explicit Source(Content content) : jpeg(std::move(content.jpeg)), decode_(std::move(content.pixels)) {}

    const cv::Mat& pixels()
    {
        std::call_once(once_, [this] {
            try {
                pixels_ = decode_();
            } catch (...) {
                problem_ = std::current_exception();
            }
        });
        if (problem_)
            std::rethrow_exception(problem_);
        return pixels_;
    }

    const Jpeg jpeg;

private:
    std::function<cv::Mat()> decode_;
    std::once_flag once_;
    cv::Mat pixels_;
    std::exception_ptr problem_;
};

Image::Image(Origin origin, Content content, Look look)
    : Image(std::move(origin), std::make_shared<Source>(std::move(content)), look)
{
}

Image::Image(Origin origin, std::shared_ptr<Source> source, Look look)
    : origin_(std::move(origin)), source_(std::move(source)), look_(look)
{
}

std::shared_ptr<const Image> Image::recaptioned() const
{
    if (!look_.overlay)
        return nullptr;
    Origin origin = origin_;
    origin.rate = 0;
    return std::shared_ptr<const Image>(new Image(std::move(origin), source_, look_));
}

std::shared_ptr<const Image> Image::of_notice(const std::string& text)
{
    return std::make_shared<Image>(Origin{}, Content{[text] { return notice(text); }, nullptr}, Look{.overlay = false});
}

const cv::Mat& Image::shown() const
{
    std::call_once(drawn_once_, [this] { drawn_ = make_shown(); });
    return drawn_;
}

const Jpeg& Image::jpeg() const
{
    std::call_once(encoded_once_, [this] { encoded_ = make_jpeg(); });
    return encoded_;
}

const Jpeg& Image::plain_jpeg() const
{
    std::call_once(plain_once_, [this] { plain_ = look_.overlay ? make_plain_jpeg() : jpeg(); });
    return plain_;
}

/// Viewers get a notice instead of a damaged image.
cv::Mat Image::make_shown() const
try {
    const cv::Mat& pixels = source_->pixels();
    return look_.overlay ? with_caption(pixels, caption(origin_, std::chrono::system_clock::now())) : pixels;
} catch (const std::exception& error) {
    return notice(error.what());
}

/// An image whose sides are longer than a JPEG's may be cannot be encoded.
Jpeg Image::make_jpeg() const
try {
    return source_->jpeg && !look_.overlay ? source_->jpeg : encode(shown(), look_.quality);
} catch (const std::exception& error) {
    return encode(notice(error.what()), look_.quality);
}

Jpeg Image::make_plain_jpeg() const
try {
    return source_->jpeg ? source_->jpeg : encode(source_->pixels(), look_.quality);
} catch (const std::exception& error) {
    return encode(notice(error.what()), look_.quality);
}

}  // namespace view
