// Encodes images as JPEG with TurboJPEG, and as PNG; the bytes are those of cv::imencode with its defaults.
#include "png_pixels.hpp"

#include <hive/error.hpp>
#include <hive/vision/image.hpp>

#include <turbojpeg.h>

#include <limits>
#include <memory>

namespace hive::vision {
namespace {

constexpr int max_jpeg_side = 65'500;
constexpr int max_png_side = 1'000'000;  // libpng's own limit

void check_type(const cv::Mat& image)
{
    if (image.empty() || image.dims != 2
        || (image.type() != CV_8UC3 && image.type() != CV_8UC1 && image.type() != CV_16UC1))
        throw Error(Errc::invalid_argument,
                    "only images of 8 bits and 1 or 3 channels, or of 16 bits and 1, can be encoded");
}

void check_size(const cv::Mat& image, int max_side, const char* format)
{
    if (image.cols > max_side || image.rows > max_side)
        throw Error(Errc::too_large, std::string(format) + ": " + std::to_string(image.cols) + "x"
                                         + std::to_string(image.rows) + " pixels; each side may have at most "
                                         + std::to_string(max_side));
}

/// TurboJPEG takes the distance between rows as an int: a narrow part of an enormous image is copied.
cv::Mat with_short_rows(const cv::Mat& image)
{
    return image.step > static_cast<std::size_t>(std::numeric_limits<int>::max()) ? image.clone() : image;
}

cv::Mat with_eight_bits(const cv::Mat& image)
{
    cv::Mat result = image;
    if (image.depth() == CV_16U)
        image.convertTo(result, CV_8U, 1.0 / 257);
    return result;
}

}  // namespace

Body encode_jpeg(const cv::Mat& image, int quality)
{
    check_type(image);
    check_size(image, max_jpeg_side, "JPEG");
    const cv::Mat pixels = with_short_rows(with_eight_bits(image));
    const bool grey = pixels.channels() == 1;
    const std::unique_ptr<void, int (*)(tjhandle)> encoder(tjInitCompress(), tjDestroy);
    if (!encoder)
        throw Error(Errc::failed, "the JPEG encoder could not be created");
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    const int status = tjCompress2(encoder.get(), pixels.data, pixels.cols, static_cast<int>(pixels.step), pixels.rows,
                                   grey ? TJPF_GRAY : TJPF_BGR, &bytes, &size, grey ? TJSAMP_GRAY : TJSAMP_420, quality,
                                   TJFLAG_ACCURATEDCT);
    const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(bytes, tjFree);
    if (status != 0)
        throw Error(Errc::failed, std::string("JPEG: ") + tjGetErrorStr2(encoder.get()));
    return std::vector(bytes, bytes + size);
}

Body encode_png(const cv::Mat& image)
{
    check_type(image);
    check_size(image, max_png_side, "PNG");
    return write_png(image);
}

}  // namespace hive::vision
