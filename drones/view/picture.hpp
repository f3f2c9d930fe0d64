// One picture to look at. It is decoded, captioned and encoded when somebody looks, once for all viewers.
#pragma once

#include "overlay.hpp"

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace view {

using Jpeg = std::shared_ptr<const std::vector<unsigned char>>;

/// May be used from any thread; the first who asks does the work.
class Picture {
public:
    struct Content {
        std::function<cv::Mat()>
            pixels;  ///< 8 bit, grey or BGR; called at most once. If it throws, a notice is shown instead
        Jpeg jpeg;   ///< as the picture came, if it came so
    };
    struct Look {
        bool overlay = true;  ///< the caption; without it a JPEG stays as it came
        int quality = 80;     ///< 1 to 100, of what is encoded here
    };

    Picture(Origin origin, Content content, Look look);
    /// What is shown until there is a picture.
    static std::shared_ptr<const Picture> of_notice(const std::string& text);

    /// The same pixels, to be captioned at the next look, without the rate that is no longer true. Nothing when it has
    /// no caption.
    [[nodiscard]] std::shared_ptr<const Picture> captioned_anew() const;

    [[nodiscard]] const Origin& origin() const noexcept { return origin_; }
    /// The pixels to show; not to be written to.
    [[nodiscard]] const cv::Mat& shown() const;
    [[nodiscard]] const Jpeg& jpeg() const;
    /// Without the caption, for a page that says the same beside it; a JPEG as it came.
    [[nodiscard]] const Jpeg& plain_jpeg() const;

private:
    class Source;

    Picture(Origin origin, std::shared_ptr<Source> source, Look look);
    [[nodiscard]] cv::Mat make_shown() const;
    [[nodiscard]] Jpeg make_jpeg() const;
    [[nodiscard]] Jpeg make_plain_jpeg() const;

    Origin origin_;
    std::shared_ptr<Source> source_;  ///< of all that are captioned anew
    Look look_;
    mutable std::once_flag drawn_once_, encoded_once_, plain_once_;
    mutable cv::Mat drawn_;
    mutable Jpeg encoded_, plain_;
};

}  // namespace view
