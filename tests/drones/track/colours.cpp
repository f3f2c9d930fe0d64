// Colours of things: an object in slightly different light stays similar, another object does not.
#include <colours.hpp>
#include <doctest/doctest.h>
#include <look.hpp>
#include <opencv2/core.hpp>

#include <numeric>

namespace {

/// Somebody in a shirt and trousers of these colours, before a grey wall.
cv::Mat person(const cv::Scalar& shirt, const cv::Scalar& trousers)
{
    cv::Mat image(120, 80, CV_8UC3, cv::Scalar::all(150)), grain(image.size(), CV_16SC3);
    image(cv::Rect(20, 10, 40, 50)) = shirt;
    image(cv::Rect(20, 60, 40, 50)) = trousers;
    cv::RNG(5).fill(grain, cv::RNG::NORMAL, 0, 4);
    cv::add(image, grain, image, cv::noArray(), CV_8U);
    return image;
}

const cv::Rect box(20, 10, 40, 100);
const cv::Scalar red(40, 40, 190), blue(180, 70, 40), black = cv::Scalar::all(30);

track::Look look_of(const cv::Mat& image, const cv::Rect& part = box)
{
    const auto numbers = colours::of(image, part);
    return track::look_of({numbers.begin(), numbers.end()});
}

double apart(const cv::Mat& a, const cv::Mat& b) { return track::difference(look_of(a), look_of(b)).value(); }

}  // namespace

TEST_CASE("colours: a thing is like itself in other light and half a size larger, and unlike one in other clothes")
{
    const cv::Mat one = person(red, black);
    cv::Mat lighter = one * 1.15;
    CHECK(apart(one, lighter) < 0.2);
    CHECK(track::difference(look_of(one), look_of(one, {24, 16, 30, 88})).value() < 0.2);
    CHECK(apart(one, person(blue, black)) > 0.5);
    CHECK(apart(one, person(black, red)) > 0.5);  // upside down it is another person
}

TEST_CASE("colours: a constant number of values for any box; only pixels in the mask count")
{
    const cv::Mat image = person(red, blue);
    for (const cv::Rect& part : {box, cv::Rect(-10, -10, 40, 40), cv::Rect(5, 5, 1, 1), cv::Rect(0, 0, 80, 120)}) {
        const auto numbers = colours::of(image, part);
        REQUIRE(numbers.size() == static_cast<std::size_t>(colours::numbers));
        CHECK(std::accumulate(numbers.begin(), numbers.end(), 0) == doctest::Approx(200).epsilon(0.06));
    }
    CHECK(colours::of(image, {500, 500, 20, 20}).empty());
    CHECK(colours::of(image, box, cv::Mat::zeros(image.size(), CV_8UC1)).empty());
    cv::Mat mask = cv::Mat::zeros(image.size(), CV_8UC1);
    mask(cv::Rect(20, 10, 40, 50)) = 255;
    const auto shirt = colours::of(image, box, mask);
    CHECK(std::accumulate(shirt.begin() + colours::numbers / 2, shirt.end(), 0) == 0);
}

TEST_CASE("colours: a grey image has greys only")
{
    const auto numbers = colours::of(cv::Mat(50, 50, CV_8UC1, cv::Scalar(255)), {0, 0, 50, 50});
    CHECK(numbers[3] > 80);
    CHECK(std::accumulate(numbers.begin() + 4, numbers.begin() + 10, 0) == 0);
}
