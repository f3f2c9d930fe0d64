// image/raw: pixels as they are, and headers that lie about them.
#include "media.hpp"

#include <doctest/doctest.h>
#include <hive/error.hpp>
#include <hive/vision/image.hpp>
#include <opencv2/imgcodecs.hpp>

using hive::Body;
using hive::Errc;
using hive::Json;
namespace vision = hive::vision;

namespace {

hive::Event raw_event(Json header, std::size_t bytes)
{
    hive::Event event;
    event.type = "image/raw";
    event.header = std::move(header);
    event.body = Body(std::vector<unsigned char>(bytes, 7));
    return event;
}

}  // namespace

TEST_CASE("raw: an image comes back exactly, grey or colour, whole or a part of another")
{
    for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
        const cv::Mat whole = media::sample({50, 40}, type), part = whole(cv::Rect(3, 4, 20, 10));
        for (const cv::Mat& image : {whole, part})
            CHECK(media::same(vision::decode(vision::encode_raw(image), "image/raw", {.sixteen_bits = true},
                                             vision::raw_header(image)),
                              image));
    }
}

TEST_CASE("raw: view shares the pixels of the body, decode owns its own")
{
    const hive::Event event = raw_event({{"width", 4}, {"height", 3}, {"pixel_format", "bgr8"}}, 36);
    CHECK(vision::view(event).data == event.body.data());
    CHECK(vision::decode(event).data != event.body.data());
    CHECK(media::same(vision::view(event), vision::decode(event)));
}

TEST_CASE("raw: encode_raw copies nothing when the pixels lie without gaps")
{
    const cv::Mat image = media::sample({8, 8}, CV_8UC3);
    CHECK(vision::encode_raw(image).data() == image.data);
}

TEST_CASE("raw: rows may be padded to a stride")
{
    const hive::Event event = raw_event({{"width", 5}, {"height", 4}, {"pixel_format", "gray8"}, {"stride", 8}}, 32);
    CHECK(vision::view(event).size() == cv::Size(5, 4));
    CHECK(vision::view(event).step == 8);
    CHECK(vision::size_of(event.body, event.type, {}, event.header) == cv::Size(5, 4));
}

TEST_CASE("raw: a header that contradicts its body is malformed")
{
    const auto header = [](Json width, Json height, Json format, Json stride) {
        return Json{{"width", std::move(width)},
                    {"height", std::move(height)},
                    {"pixel_format", std::move(format)},
                    {"stride", std::move(stride)}};
    };
    const std::vector<Json> lies{header(4, 4, "bgr8", 12),
                                 header(5, 3, "bgr8", 15),
                                 header(4, 3, "gray8", 4),
                                 header(4, 3, "rgb8", 12),
                                 header(4, 3, 24, 12),
                                 header(-4, -3, "bgr8", 12),
                                 header(0, 3, "bgr8", 12),
                                 header(4, 0, "bgr8", 12),
                                 header(4.5, 3, "bgr8", 12),
                                 header("4", 3, "bgr8", 12),
                                 header(4, 3, "bgr8", 11),
                                 header(4, 3, "bgr8", -12),
                                 header(4, 3, "bgr8", 0),
                                 header(4, 3, "bgr8", 13),
                                 header(12, 3, "bgr8", 12),
                                 header(1 << 30, 4, "gray8", 1 << 30),
                                 header(std::int64_t{1} << 62, 4, "gray8", 1),
                                 header(4, 3, "bgr8", std::int64_t{1} << 62),
                                 header(4, 3, nullptr, 12),
                                 Json::object(),
                                 Json{{"width", 4}, {"height", 3}},
                                 Json{{"pixel_format", "bgr8"}, {"height", 3}}};
    for (const Json& lie : lies) {
        CAPTURE(lie.dump());
        try {
            vision::view(raw_event(lie, 36));
            FAIL_CHECK("taken although it lies");
        } catch (const hive::Error& error) {
            CHECK(error.code() == Errc::malformed);
        }
    }
}

TEST_CASE("raw: more pixels than allowed are too large")
{
    try {
        vision::view(raw_event({{"width", 1 << 20}, {"height", 1 << 20}, {"pixel_format", "gray8"}}, 16));
        FAIL("taken although too large");
    } catch (const hive::Error& error) {
        CHECK(error.code() == Errc::too_large);
    }
}

TEST_CASE("raw: an image of 16 bits is decoded on request only, and otherwise refused with a reason")
{
    const cv::Mat image(3, 4, CV_16UC1, cv::Scalar(40'000));
    const auto header = vision::raw_header(image);
    CHECK(header.at("pixel_format") == "gray16");
    CHECK(header.at("stride") == 8);
    try {
        vision::decode(vision::encode_raw(image), "image/raw", {}, header);
        FAIL("taken for 8 bits");
    } catch (const hive::Error& error) {
        CHECK(error.code() == Errc::unsupported);
        CHECK(std::string(error.what()).find("gray16") != std::string::npos);
    }
}

TEST_CASE("raw: alpha is dropped, and other than 8 bits is refused with advice for its sender")
{
    const cv::Mat with_alpha(3, 4, CV_8UC4, cv::Scalar(1, 2, 3, 4));
    const auto header = vision::raw_header(with_alpha);
    CHECK(header.at("pixel_format") == "bgra8");
    const auto body = vision::encode_raw(with_alpha);
    CHECK(media::same(vision::decode(body, "image/raw", {}, header), cv::Mat(3, 4, CV_8UC3, cv::Scalar(1, 2, 3))));
    CHECK(vision::size_of(body, "image/raw", {}, header) == cv::Size(4, 3));
    for (const auto& [type, word] : {std::pair{CV_16UC3, "bgr16"},
                                     {CV_16UC4, "bgra16"},
                                     {CV_32FC1, "gray32f"},
                                     {CV_32FC3, "bgr32f"},
                                     {CV_32FC4, "bgra32f"}}) {
        CAPTURE(word);
        const cv::Mat image(3, 4, type, cv::Scalar::all(1));
        const auto described = vision::raw_header(image);
        CHECK(described.at("pixel_format") == word);
        try {
            vision::decode(vision::encode_raw(image), "image/raw", {.sixteen_bits = true}, described);
            FAIL_CHECK("taken for 8 bits");
        } catch (const hive::Error& error) {
            CHECK(error.code() == Errc::unsupported);
            CHECK(std::string(error.what()).find(word) != std::string::npos);
            CHECK(std::string(error.what()).find("; let its sender ") != std::string::npos);
        }
    }
    CHECK_THROWS_AS(vision::raw_header(cv::Mat(3, 4, CV_64FC1)), hive::Error);
}

TEST_CASE("raw: PNG keeps 16 bits, JPEG the upper eight")
{
    const cv::Mat image(30, 40, CV_16UC1, cv::Scalar(40'000));
    const Body png = vision::encode_png(image);
    const cv::Mat bytes(1, static_cast<int>(png.size()), CV_8UC1, const_cast<unsigned char*>(png.data()));
    CHECK(media::same(cv::imdecode(bytes, cv::IMREAD_UNCHANGED), image));
    const cv::Mat jpeg = vision::decode(vision::encode_jpeg(image, 95), "image/jpeg");
    CHECK(std::abs(jpeg.at<cv::Vec3b>(15, 20)[0] - 40'000 / 257) <= 1);
    CHECK(vision::plain_form({8192, 8192}, 1, 16).type == "image/png");
    CHECK(vision::plain_form({64, 48}, 1, 16).header.at("pixel_format") == "gray16");
}
