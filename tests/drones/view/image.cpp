// Images that work only when looked at, and the exchange of the newest.
#include "exchange.hpp"
#include "window.hpp"

#include <doctest/doctest.h>
#include <opencv2/imgcodecs.hpp>

#include <stdexcept>
#include <thread>

using namespace std::chrono_literals;
using view::Image;

namespace {

view::Jpeg jpeg_of(const cv::Mat& image)
{
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", image, bytes);
    return std::make_shared<const std::vector<unsigned char>>(bytes);
}

const cv::Mat grey(120, 160, CV_8UC3, cv::Scalar::all(90));

}  // namespace

TEST_CASE("image: nothing is decoded without a viewer, then once for all viewers")
{
    int decoded = 0;
    const Image image({},
                      {[&] {
                           ++decoded;
                           return grey;
                       },
                       nullptr},
                      {});
    CHECK(decoded == 0);
    std::vector<view::Jpeg> seen(4);
    {
        std::vector<std::jthread> lookers;
        for (auto& jpeg : seen)
            lookers.emplace_back([&] { jpeg = image.jpeg(); });
    }
    CHECK(image.shown().size() == grey.size());
    CHECK(decoded == 1);
    for (const auto& jpeg : seen)
        CHECK(jpeg == seen.front());  // the same bytes, not equal ones
    CHECK(cv::imdecode(*seen.front(), cv::IMREAD_COLOR).size() == grey.size());
}

TEST_CASE("image: without overlay a JPEG is unchanged and not decoded; with overlay it is drawn on")
{
    const auto came = jpeg_of(grey);
    bool decoded = false;
    const auto content = [&] {
        return Image::Content{[&] {
                                  decoded = true;
                                  return grey;
                              },
                              came};
    };
    CHECK(Image({}, content(), {.overlay = false}).jpeg() == came);
    CHECK_FALSE(decoded);
    CHECK(*Image({"camera.image", "camera"}, content(), {.overlay = true}).jpeg() != *came);
    CHECK(decoded);
}

TEST_CASE("image: without its caption it is the received image, a JPEG byte for byte")
{
    const auto came = jpeg_of(grey);
    const Image of_jpeg({"camera.image", "camera"}, {[] { return grey; }, came}, {.overlay = true});
    CHECK(of_jpeg.plain_jpeg() == came);
    CHECK(*of_jpeg.jpeg() != *came);
    const Image of_pixels({"camera.image", "camera"}, {[] { return grey; }, nullptr}, {.overlay = true});
    CHECK(*of_pixels.plain_jpeg() == *Image({}, {[] { return grey; }, nullptr}, {.overlay = false}).jpeg());
    const Image damaged({}, {[]() -> cv::Mat { throw std::runtime_error("cut short"); }, nullptr}, {});
    CHECK(*damaged.plain_jpeg() == *damaged.jpeg());
}

TEST_CASE("window: an image larger than the screen is scaled with its aspect ratio; others are unchanged")
{
    const auto shown = [](cv::Size size, std::optional<cv::Size> room) {
        return view::Window::fitted(cv::Mat(size, CV_8UC3, cv::Scalar::all(9)), room).size();
    };
    CHECK(shown({640, 480}, cv::Size(1824, 950)) == cv::Size(640, 480));
    CHECK(shown({3840, 2160}, cv::Size(1824, 950)) == cv::Size(1688, 950));
    CHECK(shown({1000, 4000}, cv::Size(1824, 1000)) == cv::Size(250, 1000));
    CHECK(shown({30'000, 2}, cv::Size(1000, 900)) == cv::Size(1000, 1));
    CHECK(shown({3840, 2160}, std::nullopt) == cv::Size(3840, 2160));
}

TEST_CASE("image: a lower quality takes fewer bytes")
{
    cv::Mat noise(240, 320, CV_8UC3);
    cv::randu(noise, 0, 255);
    const auto size = [&](int quality) {
        return Image({}, {[&] { return noise; }, nullptr}, {false, quality}).jpeg()->size();
    };
    CHECK(size(30) < size(90));
}

TEST_CASE("image: one that is damaged, or too long for a JPEG, becomes a notice with the reason")
{
    const Image damaged({}, {[]() -> cv::Mat { throw std::runtime_error("the JPEG is cut short"); }, nullptr}, {});
    CHECK(cv::norm(damaged.shown(), view::notice("the JPEG is cut short")) == 0);
    const Image longest({}, {[] { return cv::Mat(1, 70'000, CV_8UC1, cv::Scalar::all(0)); }, nullptr},
                        {.overlay = false});
    CHECK(longest.shown().cols == 70'000);
    CHECK(cv::imdecode(*longest.jpeg(), cv::IMREAD_COLOR).size() == view::notice("").size());
}

TEST_CASE("exchange: a slow reader gets the newest; unviewed images are freed")
{
    view::Exchange exchange(Image::of_notice("no image yet"));
    CHECK(exchange.newest().number == 0);
    std::weak_ptr<const Image> first;
    for (int i = 1; i <= 3; ++i) {
        const auto image = std::make_shared<const Image>(view::Origin{.sender = {}, .source = {}, .sequence = i},
                                                         Image::Content{[] { return grey; }, nullptr}, Image::Look{});
        exchange.put(image);
        if (i == 1)
            first = image;
    }
    CHECK(exchange.newest().number == 3);
    CHECK(exchange.newest().image->origin().sequence == 3);
    CHECK(first.expired());
}

TEST_CASE(
    "image: with another caption it has no rate, the same pixels, which are not decoded again, and the same problem")
{
    int decoded = 0;
    const view::Origin origin{.sender = "camera.image",
                              .source = "camera",
                              .sequence = 7,
                              .size = grey.size(),
                              .captured = std::chrono::system_clock::now(),
                              .rate = 29.8};
    const Image image(origin,
                      {[&] {
                           ++decoded;
                           return grey;
                       },
                       nullptr},
                      {});
    const auto before = image.jpeg();
    const auto updated = image.recaptioned();
    REQUIRE(updated);
    CHECK(updated->origin().rate == 0);
    CHECK(updated->origin().sequence == 7);
    CHECK(*updated->jpeg() != *before);
    CHECK(decoded == 1);
    int tried = 0;
    const Image damaged({},
                        {[&]() -> cv::Mat {
                             ++tried;
                             throw std::runtime_error("cut short");
                         },
                         nullptr},
                        {});
    CHECK(cv::norm(damaged.shown(), damaged.recaptioned()->shown()) == 0);
    CHECK(tried == 1);
    CHECK_FALSE(Image(origin, {[] { return grey; }, nullptr}, {.overlay = false}).recaptioned());
}

TEST_CASE("exchange: after the last image, its text is updated once per second for all viewers")
{
    const view::Exchange::Time begin{1000s};
    view::Exchange exchange(Image::of_notice("no image yet"));
    CHECK(exchange.newest(begin).version == exchange.newest(begin + 1h).version);
    const auto put = [&](double rate, bool overlay) {
        exchange.put(std::make_shared<const Image>(view::Origin{.sender = "a.b", .source = "a", .rate = rate},
                                                   Image::Content{[] { return grey; }, nullptr},
                                                   Image::Look{.overlay = overlay}),
                     begin);
        return exchange.newest(begin);
    };
    const auto first = put(29.8, true);
    CHECK(exchange.newest(begin + 1999ms).image == first.image);
    const auto old = exchange.newest(begin + 2s);
    CHECK(old.version == first.version + 1);
    CHECK(old.number == first.number);
    CHECK(old.since == first.since);
    CHECK(old.image->origin().rate == 0);
    CHECK(exchange.newest(begin + 2999ms).image == old.image);
    CHECK(exchange.newest(begin + 3s).version == first.version + 2);
    CHECK(put(29.8, true).version == first.version + 3);
    const auto slow = put(0.2, true);
    CHECK(exchange.newest(begin + 9s).version == slow.version);  // one in five seconds
    CHECK(exchange.newest(begin + 10s).version == slow.version + 1);
    const auto plain = put(29.8, false);
    CHECK(exchange.newest(begin + 1h).image == plain.image);
}

TEST_CASE("rate: that of the last two seconds, or since the previous image; unknown from one")
{
    view::Rate rate;
    const view::Exchange::Time begin{100s};
    CHECK(rate.count(begin) == 0);
    double last = 0;
    for (int i = 1; i <= 50; ++i)
        last = rate.count(begin + i * 100ms);
    CHECK(last == doctest::Approx(10));
    for (int i = 1; i <= 100; ++i)
        last = rate.count(begin + 5s + i * 25ms);
    CHECK(last == doctest::Approx(40));
    CHECK(rate.count(begin + 60s) == doctest::Approx(1 / 52.5));  // after the pause; one in ten seconds is a rate too
    CHECK(rate.count(begin + 70s) == doctest::Approx(0.1));
}
