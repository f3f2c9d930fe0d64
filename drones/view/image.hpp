// One image for viewers. It is decoded, captioned and encoded on the first request, once for all viewers.
#pragma once

#include "overlay.hpp"

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace view {

using Jpeg = std::shared_ptr<const std::vector<unsigned char>>;

/// For any thread; the first caller does the work.
class Image {
public:
    struct Content {
        std::function<cv::Mat()>
            pixels;  ///< 8 bit, grey or BGR; called at most once. If it throws, a notice is shown instead
        Jpeg jpeg;   ///< the received bytes, if they are a JPEG
    };
    struct Look {
        bool overlay = true;  ///< the caption; without it a JPEG stays unchanged
        int quality = 80;     ///< 1 to 100, of JPEGs encoded here
    };

    Image(Origin origin, Content content, Look look);
    /// The notice until there is an image.
    static std::shared_ptr<const Image> of_notice(const std::string& text);

    /// The same pixels, to be captioned at the next request, without the outdated rate. Nothing if it has no caption.
    [[nodiscard]] std::shared_ptr<const Image> recaptioned() const;

    [[nodiscard]] const Origin& origin() const noexcept { return origin_; }
    /// The pixels to show; not to be written to.
    [[nodiscard]] const cv::Mat& shown() const;
    [[nodiscard]] const Jpeg& jpeg() const;
    /// Without the caption, for a page that shows it separately; a JPEG stays unchanged.
    [[nodiscard]] const Jpeg& plain_jpeg() const;

private:
    class Source;

    Image(Origin origin, std::shared_ptr<Source> source, Look look);
    [[nodiscard]] cv::Mat make_shown() const;
    [[nodiscard]] Jpeg make_jpeg() const;
    [[nodiscard]] Jpeg make_plain_jpeg() const;

    Origin origin_;
    std::shared_ptr<Source> source_;  ///< shared by all copies with a new caption
    Look look_;
    mutable std::once_flag drawn_once_, encoded_once_, plain_once_;
    mutable cv::Mat drawn_;
    mutable Jpeg encoded_, plain_;
};

}  // namespace view
