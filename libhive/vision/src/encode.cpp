// Pictures to JPEG and PNG.
#include <hive/error.hpp>
#include <hive/vision/image.hpp>

#include <opencv2/imgcodecs.hpp>

namespace hive::vision {
namespace {

Body encode(const char* suffix, const cv::Mat& picture, const std::vector<int>& options)
{
    if (picture.empty() || (picture.type() != CV_8UC3 && picture.type() != CV_8UC1 && picture.type() != CV_16UC1))
        throw Error(Errc::invalid_argument,
                    "only pictures of 8 bits and 1 or 3 channels, or of 16 bits and 1, are encoded");
    std::vector<unsigned char> bytes;
    if (!cv::imencode(suffix, picture, bytes, options))
        throw Error(Errc::failed, "the picture could not be encoded");
    return bytes;
}

}  // namespace

Body encode_jpeg(const cv::Mat& picture, int quality)
{
    cv::Mat eight_bits = picture;
    if (picture.type() == CV_16UC1)
        picture.convertTo(eight_bits, CV_8U, 1.0 / 257);
    return encode(".jpg", eight_bits, {cv::IMWRITE_JPEG_QUALITY, quality});
}

Body encode_png(const cv::Mat& picture) { return encode(".png", picture, {}); }

}  // namespace hive::vision
