// Valid images: decode() returns the same bits as OpenCV.
#include "media.hpp"

#include <doctest/doctest.h>
#include <hive/error.hpp>
#include <hive/vision/image.hpp>
#include <opencv2/imgcodecs.hpp>
#include <turbojpeg.h>

#include <algorithm>
#include <iterator>

using hive::Body;
using hive::Errc;
namespace vision = hive::vision;

namespace {

Errc decode_refusal(const media::Bytes& bytes, const std::string& type)
{
    try {
        vision::decode(Body(bytes), type);
    } catch (const hive::Error& error) {
        return error.code();
    }
    FAIL("decoded although it should not");
    return Errc::failed;
}

void check_like_opencv(const media::Bytes& bytes, const std::string& type)
{
    const cv::Mat expected = cv::imdecode(bytes, cv::IMREAD_COLOR);
    REQUIRE_FALSE(expected.empty());
    CHECK(media::same(vision::decode(Body(bytes), type), expected));
    CHECK(vision::size_of(Body(bytes), type) == expected.size());
}

/// As programs for print write them, with their inks inverted.
media::Bytes printed(const cv::Mat& inks, int flags)
{
    const auto encoder = tjInitCompress();
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    REQUIRE(tjCompress2(encoder, inks.data, inks.cols, static_cast<int>(inks.step), inks.rows, TJPF_CMYK, &bytes, &size,
                        TJSAMP_444, 90, flags)
            == 0);
    media::Bytes jpeg(bytes, bytes + size);
    tjFree(bytes);
    tjDestroy(encoder);
    return jpeg;
}

/// The JPEG with an EXIF segment of one entry, the orientation.
media::Bytes with_orientation(const media::Bytes& jpeg, unsigned char orientation, bool big_endian)
{
    const media::Bytes segment{0xFF, 0xE1, 0, 34, 'E', 'x', 'i', 'f', 0, 0};
    const media::Bytes big{'M', 'M', 0, 42, 0, 0, 0,           8, 0, 1, 1, 0x12, 0,
                           3,   0,   0, 0,  1, 0, orientation, 0, 0, 0, 0, 0,    0};
    const media::Bytes little{'I', 'I', 42, 0, 8, 0,           0, 0, 1, 0, 0x12, 1, 3,
                              0,   1,   0,  0, 0, orientation, 0, 0, 0, 0, 0,    0, 0};
    media::Bytes result;
    std::copy(jpeg.begin(), jpeg.begin() + 2, std::back_inserter(result));
    std::ranges::copy(segment, std::back_inserter(result));
    std::ranges::copy(big_endian ? big : little, std::back_inserter(result));
    std::copy(jpeg.begin() + 2, jpeg.end(), std::back_inserter(result));
    return result;
}

}  // namespace

TEST_CASE("decode: every photograph of the media equals cv::imdecode bit for bit (needs media)")
{
    for (const auto& path : media::images({".jpg", ".png"})) {
        CAPTURE(path.filename().string());
        check_like_opencv(media::read(path), path.extension() == ".png" ? "image/png" : "image/jpeg");
    }
}

TEST_CASE("decode: JPEGs of many kinds equal cv::imdecode bit for bit")
{
    const std::vector<std::vector<int>> kinds{{},
                                              {cv::IMWRITE_JPEG_QUALITY, 10},
                                              {cv::IMWRITE_JPEG_QUALITY, 100, cv::IMWRITE_JPEG_PROGRESSIVE, 1},
                                              {cv::IMWRITE_JPEG_RST_INTERVAL, 2},
                                              {cv::IMWRITE_JPEG_OPTIMIZE, 1}};
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(17, 9), cv::Size(320, 240)})
        for (const int type : {CV_8UC1, CV_8UC3})
            for (const auto& kind : kinds)
                check_like_opencv(media::encoded(".jpg", media::sample(size, type), kind), "image/jpeg");
}

TEST_CASE("decode: a JPEG for print equals cv::imdecode, and its paper is white")
{
    const cv::Mat inks = media::sample({40, 31}, CV_8UC4);
    for (const int flags : {0, TJFLAG_PROGRESSIVE}) {
        const media::Bytes jpeg = printed(inks, flags);
        check_like_opencv(jpeg, "image/jpeg");
        check_like_opencv(with_orientation(jpeg, 6, true), "image/jpeg");
        CHECK(decode_refusal(media::Bytes(jpeg.begin(), jpeg.end() - 100), "image/jpeg") == Errc::malformed);
    }
    const cv::Mat paper = vision::decode(Body(printed(cv::Mat(8, 8, CV_8UC4, cv::Scalar::all(255)), 0)), "image/jpeg");
    CHECK(paper.at<cv::Vec3b>(4, 4) == cv::Vec3b(255, 255, 255));
}

TEST_CASE("decode: PNGs of many kinds equal cv::imdecode bit for bit")
{
    for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3})
        check_like_opencv(media::encoded(".png", media::sample({33, 21}, type)), "image/png");
}

TEST_CASE("decode: a JPEG is turned upright by its EXIF orientation")
{
    const media::Bytes jpeg = media::encoded(".jpg", media::sample({48, 20}, CV_8UC3));
    for (unsigned char orientation = 0; orientation <= 9; ++orientation)
        for (const bool big_endian : {false, true}) {
            CAPTURE(int{orientation});
            check_like_opencv(with_orientation(jpeg, orientation, big_endian), "image/jpeg");
        }
    CHECK(vision::size_of(Body(with_orientation(jpeg, 6, true)), "image/jpeg") == cv::Size(20, 48));
}

TEST_CASE("decode: only the declared type is tried")
{
    const cv::Mat image = media::sample({20, 20}, CV_8UC3);
    CHECK(decode_refusal(media::encoded(".png", image), "image/jpeg") == Errc::malformed);
    CHECK(decode_refusal(media::encoded(".jpg", image), "image/png") == Errc::malformed);
    CHECK(decode_refusal(media::encoded(".bmp", image), "image/png") == Errc::malformed);
    CHECK(decode_refusal(media::encoded(".bmp", image), "image/bmp") == Errc::unsupported);
    CHECK(decode_refusal(media::encoded(".jpg", image), "") == Errc::unsupported);
    CHECK(decode_refusal(media::encoded(".jpg", image), "image/*") == Errc::unsupported);
}

TEST_CASE("decode: bytes behind the end of a JPEG do not matter")
{
    media::Bytes jpeg = media::encoded(".jpg", media::sample({40, 30}, CV_8UC3));
    const cv::Mat expected = cv::imdecode(jpeg, cv::IMREAD_COLOR);
    jpeg.insert(jpeg.end(), {0, 0, 0xFF, 0xD8, 1});
    CHECK(media::same(vision::decode(Body(jpeg), "image/jpeg"), expected));
}

TEST_CASE("decode: an image larger than declared in its event's header is refused")
{
    hive::Event event;
    event.type = "image/jpeg";
    event.body = Body(media::encoded(".jpg", media::sample({40, 30}, CV_8UC3)));
    CHECK(vision::decode(event).size() == cv::Size(40, 30));
    event.header = {{"width", 30}, {"height", 40}};  // the same number of pixels: turned by EXIF somewhere
    CHECK(vision::decode(event).size() == cv::Size(40, 30));
    event.header = {{"width", 40}, {"height", 29}};
    CHECK_THROWS_AS(vision::decode(event), hive::Error);
    event.header = {{"width", -40}, {"height", -30}};
    CHECK_THROWS_AS(vision::decode(event), hive::Error);
}
