// JPEG and PNG of this library are those of cv::imencode, also from a part of a larger image.
#include "media.hpp"

#include <doctest/doctest.h>
#include <hive/error.hpp>
#include <hive/vision/image.hpp>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>

using hive::Body;
using hive::Errc;
namespace vision = hive::vision;

namespace {

constexpr int all_types[] = {CV_8UC1, CV_8UC3, CV_16UC1};

/// One whole, one whose rows have a gap between them.
std::vector<cv::Mat> whole_and_part(cv::Size size, int type)
{
    const cv::Mat larger = media::sample({size.width + 7, size.height + 5}, type);
    return {media::sample(size, type), larger(cv::Rect({3, 4}, size))};
}

media::Bytes encoded_bytes(const Body& body) { return {body.data(), body.data() + body.size()}; }

template <class Encode>
Errc encode_refusal(Encode encode)
{
    try {
        encode();
    } catch (const hive::Error& error) {
        return error.code();
    }
    FAIL("encoded although it should not");
    return Errc::failed;
}

}  // namespace

TEST_CASE("encode: a PNG has every pixel, for every type and gap between rows")
{
    for (const int type : all_types)
        for (const cv::Size size : {cv::Size(1, 1), cv::Size(17, 9), cv::Size(320, 240)})
            for (const cv::Mat& image : whole_and_part(size, type)) {
                CAPTURE(type);
                CHECK(media::same(cv::imdecode(encoded_bytes(vision::encode_png(image)), cv::IMREAD_UNCHANGED), image));
            }
}

TEST_CASE("encode: a PNG is as small as that of cv::imencode")
{
    for (const int type : all_types) {
        const cv::Mat image = media::sample({320, 240}, type);
        const auto expected = media::encoded(".png", image).size();
        CAPTURE(type);
        CHECK(vision::encode_png(image).size() <= expected + expected / 50);
    }
}

TEST_CASE("encode: a JPEG is that of cv::imencode, byte for byte")
{
    for (const int type : {CV_8UC1, CV_8UC3})
        for (const cv::Size size : {cv::Size(1, 1), cv::Size(17, 9), cv::Size(320, 240)})
            for (const cv::Mat& image : whole_and_part(size, type))
                for (const int quality : {1, 55, 80, 95, 96, 100}) {
                    CAPTURE(type);
                    CAPTURE(quality);
                    CHECK(encoded_bytes(vision::encode_jpeg(image, quality))
                          == media::encoded(".jpg", image, {cv::IMWRITE_JPEG_QUALITY, quality}));
                }
}

TEST_CASE("encode: a JPEG is close to its image; of 16 bits it has the upper eight")
{
    for (const int type : all_types) {
        cv::Mat smooth(48, 64, type);
        for (int x = 0; x < smooth.cols; ++x)
            smooth.col(x).setTo(cv::Scalar::all(type == CV_16UC1 ? x * 1'000 : x * 4));
        cv::Mat expected, grey;
        smooth.convertTo(expected, CV_8U, type == CV_16UC1 ? 1.0 / 257 : 1.0);
        const auto part = expected(cv::Rect(8, 4, 40, 30));
        const Body jpeg = vision::encode_jpeg(smooth(cv::Rect(8, 4, 40, 30)), 95);
        const auto flags = part.channels() == 1 ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR;
        CAPTURE(type);
        CHECK(cv::norm(cv::imdecode(encoded_bytes(jpeg), flags), part, cv::NORM_INF) <= 3);
    }
}

TEST_CASE("encode: other types and no pixels are refused")
{
    for (const cv::Mat& image : {cv::Mat(), cv::Mat(4, 4, CV_32FC3), cv::Mat(4, 4, CV_8UC4), cv::Mat(4, 4, CV_16UC3)}) {
        CHECK(encode_refusal([&] { vision::encode_jpeg(image, 80); }) == Errc::invalid_argument);
        CHECK(encode_refusal([&] { vision::encode_png(image); }) == Errc::invalid_argument);
    }
}

TEST_CASE("encode: sides that a format does not have are refused, the largest are not")
{
    CHECK_FALSE(vision::encode_jpeg(cv::Mat(1, 65'500, CV_8UC1, cv::Scalar(9)), 80).empty());
    CHECK(encode_refusal([] { vision::encode_jpeg(cv::Mat(1, 65'501, CV_8UC1, cv::Scalar(9)), 80); })
          == Errc::too_large);
    CHECK(encode_refusal([] { vision::encode_jpeg(cv::Mat(65'501, 1, CV_8UC3, cv::Scalar(9)), 80); })
          == Errc::too_large);
    CHECK_FALSE(vision::encode_png(cv::Mat(1, 1'000'000, CV_8UC1, cv::Scalar(9))).empty());
    CHECK(encode_refusal([] { vision::encode_png(cv::Mat(1, 1'000'001, CV_8UC1, cv::Scalar(9))); }) == Errc::too_large);
    CHECK(encode_refusal([] { vision::encode_jpeg(cv::Mat(1, 1, CV_8UC1, cv::Scalar(9)), 101); }) == Errc::failed);
}
