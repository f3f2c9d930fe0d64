// Pictures that work only when looked at, and the exchange of the newest.
#include "exchange.hpp"

#include <doctest/doctest.h>
#include <opencv2/imgcodecs.hpp>

#include <stdexcept>
#include <thread>

using namespace std::chrono_literals;
using view::Picture;

namespace {

view::Jpeg jpeg_of(const cv::Mat& picture)
{
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", picture, bytes);
    return std::make_shared<const std::vector<unsigned char>>(bytes);
}

const cv::Mat grey(120, 160, CV_8UC3, cv::Scalar::all(90));

}  // namespace

TEST_CASE("picture: nothing is decoded until somebody looks, then once for all who do")
{
    int decoded = 0;
    const Picture picture({}, {[&] { ++decoded; return grey; }, nullptr}, {});
    CHECK(decoded == 0);
    std::vector<view::Jpeg> seen(4);
    {
        std::vector<std::jthread> lookers;
        for (auto& jpeg : seen)
            lookers.emplace_back([&] { jpeg = picture.jpeg(); });
    }
    CHECK(picture.shown().size() == grey.size());
    CHECK(decoded == 1);
    for (const auto& jpeg : seen)
        CHECK(jpeg == seen.front());  // the same bytes, not equal ones
    CHECK(cv::imdecode(*seen.front(), cv::IMREAD_COLOR).size() == grey.size());
}

TEST_CASE("picture: without overlay a JPEG stays as it came and is not decoded; with overlay it is drawn on")
{
    const auto came = jpeg_of(grey);
    bool decoded = false;
    const auto content = [&] { return Picture::Content{[&] { decoded = true; return grey; }, came}; };
    CHECK(Picture({}, content(), {.overlay = false}).jpeg() == came);
    CHECK_FALSE(decoded);
    CHECK(*Picture({"camera.image", "camera"}, content(), {.overlay = true}).jpeg() != *came);
    CHECK(decoded);
}

TEST_CASE("picture: a lower quality takes fewer bytes")
{
    cv::Mat noise(240, 320, CV_8UC3);
    cv::randu(noise, 0, 255);
    const auto size = [&](int quality) { return Picture({}, {[&] { return noise; }, nullptr}, {false, quality}).jpeg()->size(); };
    CHECK(size(30) < size(90));
}

TEST_CASE("picture: one that is damaged, or too long for a JPEG, becomes a notice that says so")
{
    const Picture damaged({}, {[]() -> cv::Mat { throw std::runtime_error("the JPEG is cut short"); }, nullptr}, {});
    CHECK(cv::norm(damaged.shown(), view::notice("the JPEG is cut short")) == 0);
    const Picture longest({}, {[] { return cv::Mat(1, 70'000, CV_8UC1, cv::Scalar::all(0)); }, nullptr}, {.overlay = false});
    CHECK(longest.shown().cols == 70'000);
    CHECK(cv::imdecode(*longest.jpeg(), cv::IMREAD_COLOR).size() == view::notice("").size());
}

TEST_CASE("exchange: a slow reader finds the newest; what nobody looked at is gone, with its memory")
{
    view::Exchange exchange(Picture::of_notice("no picture yet"));
    CHECK(exchange.newest().number == 0);
    std::weak_ptr<const Picture> first;
    for (int i = 1; i <= 3; ++i) {
        const auto picture = std::make_shared<const Picture>(view::Origin{.sender = {}, .source = {}, .sequence = i}, Picture::Content{[] { return grey; }, nullptr}, Picture::Look{});
        exchange.put(picture);
        if (i == 1)
            first = picture;
    }
    CHECK(exchange.newest().number == 3);
    CHECK(exchange.newest().picture->origin().sequence == 3);
    CHECK(first.expired());
}

TEST_CASE("rate: is that of the last two seconds, or since the picture before; not known from one")
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
