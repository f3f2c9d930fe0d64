// The encoder of images: type, body and header of its results, and unchanged events.
#include "media.hpp"

#include <doctest/doctest.h>
#include <hive/error.hpp>
#include <hive/vision/encoder.hpp>
#include <hive/vision/image.hpp>
#include <opencv2/core.hpp>

using hive::Errc;
using hive::Event;
using hive::Json;
namespace vision = hive::vision;

namespace {

const hive::Encoder encoder = vision::encoder();

Event raw_event(const cv::Mat& image)
{
    Event event;
    event.type = "image/raw";
    event.header = vision::raw_header(image, {{"index", 7}});
    event.body = vision::encode_raw(image);
    event.size = event.body.size();
    return event;
}

Event jpeg_event(const cv::Mat& image)
{
    Event event;
    event.type = "image/jpeg";
    event.header = {{"index", 7}, {"width", image.cols}, {"height", image.rows}};
    event.body = vision::encode_jpeg(image, 90);
    return event;
}

Errc refusal(const std::string& encoding)
{
    try {
        static_cast<void>(hive::encoding_named(encoder.encodings, encoding));
    } catch (const hive::Error& error) {
        return error.code();
    }
    return Errc::io;
}

/// How far two images are apart, grey levels on average.
double distance(const cv::Mat& a, const cv::Mat& b)
{
    return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total() * a.elemSize());
}

}  // namespace

TEST_CASE("encoder: raw to jpeg and back keeps the size, the kind of pixels and the rest of the header")
{
    const cv::Mat image = media::sample({64, 48}, CV_8UC3);
    const Event jpeg = encoder.encode(raw_event(image), "jpeg");
    CHECK(jpeg.type == "image/jpeg");
    CHECK(jpeg.header == Json{{"index", 7}, {"width", 64}, {"height", 48}});
    CHECK(jpeg.size == jpeg.body.size());
    CHECK(jpeg.body.size() < 64 * 48 * 3 / 2);
    const Event raw = encoder.encode(jpeg, "raw");
    CHECK(raw.type == "image/raw");
    CHECK(raw.header == Json{{"index", 7}, {"width", 64}, {"height", 48}, {"pixel_format", "bgr8"}, {"stride", 192}});
    CHECK(raw.body.size() == 64 * 48 * 3);
    CHECK(distance(vision::view(raw), image) < 12);
}

TEST_CASE("encoder: png keeps every pixel, of a grey image the grey")
{
    const cv::Mat image = media::sample({40, 30}, CV_8UC1);
    const Event png = encoder.encode(raw_event(image), "png");
    CHECK(png.type == "image/png");
    cv::Mat grey;
    cv::extractChannel(vision::view(png), grey, 0);  // decoding gives three equal channels
    CHECK(media::same(grey, image));
    CHECK(encoder.encode(raw_event(image), "jpeg:90").body.size() > 100);
}

TEST_CASE("encoder: rows with gaps between them are encoded like the same image without")
{
    const cv::Mat whole = media::sample({50, 20}, CV_8UC3), padded(20, 64, CV_8UC3, cv::Scalar::all(0)),
                  part = padded.colRange(0, 50);
    whole.copyTo(part);
    Event event = raw_event(whole);
    event.header["stride"] = 64 * 3;
    event.body = vision::encode_raw(padded);
    const Event png = encoder.encode(event, "png");
    CHECK(media::same(vision::view(png), whole));
    CHECK_FALSE(png.header.contains("stride"));
}

TEST_CASE("encoder: a word without a number leaves its own type untouched, byte for byte")
{
    const cv::Mat image = media::sample({64, 48}, CV_8UC3);
    const Event jpeg = jpeg_event(image), raw = raw_event(image);
    CHECK(encoder.encode(jpeg, "jpeg").body.data() == jpeg.body.data());
    CHECK(encoder.encode(jpeg, "jpeg").header == jpeg.header);
    CHECK(encoder.encode(raw, "raw").body.data() == raw.body.data());
}

TEST_CASE("encoder: a quality that was asked for is always the one that comes")
{
    const cv::Mat image = media::sample({64, 48}, CV_8UC3);
    const auto bytes = [&](const Event& event, const char* encoding) {
        return encoder.encode(event, encoding).body.size();
    };
    const Event raw = raw_event(image), jpeg = jpeg_event(image);
    CHECK(bytes(raw, "jpeg:30") < bytes(raw, "jpeg:80"));
    CHECK(bytes(raw, "jpeg:80") == bytes(raw, "jpeg"));
    CHECK(bytes(jpeg, "jpeg:30") < jpeg.body.size());
}

TEST_CASE("encoder: it knows raw, png, jpeg and the qualities 1 to 100, and refuses the rest by name")
{
    for (const char* known : {"raw", "png", "jpeg", "jpeg:1", "jpeg:100"})
        CHECK_MESSAGE(refusal(known) == Errc::io, known);
    for (const char* unknown : {"webp", "jpeg:0", "jpeg:101", "jpeg:999999", "jpeg:", "png:3", "raw:1", "jpeg:8x"})
        CHECK_MESSAGE(refusal(unknown) == Errc::invalid_argument, unknown);
    try {
        encoder.encode(jpeg_event(media::sample({8, 8}, CV_8UC3)), "webp");
        FAIL("webp was taken");
    } catch (const hive::Error& error) {
        CHECK(error.what() == doctest::String("there is no encoding \"webp\""));
        CHECK(error.advice() == "there are jpeg, jpeg:1 to jpeg:100, png, raw");
    }
}

TEST_CASE("encoder: a damaged image is refused, not encoded in part")
{
    Event jpeg = jpeg_event(media::sample({64, 48}, CV_8UC3));
    jpeg.body = hive::Body(jpeg.body.bytes().first(jpeg.body.size() / 2), std::make_shared<hive::Body>(jpeg.body));
    CHECK_THROWS_AS(encoder.encode(jpeg, "raw"), hive::Error);
}
