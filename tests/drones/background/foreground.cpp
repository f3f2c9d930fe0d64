// The foreground finder: moving objects are found in place; changes start a new model.
#include "media.hpp"
#include "overlap.hpp"

#include <doctest/doctest.h>
#include <foreground_finder.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

using background::Foreground;
using background::ForegroundFinder;

namespace {

const cv::Size size(160, 120);

/// A grainy wall, and from image 20 on a disc that moves before it.
class Clip {
public:
    cv::Mat frame(int index)
    {
        cv::Mat image(size, CV_8UC3), grain(size, CV_16SC3);
        image.setTo(cv::Scalar(90, 110, 130));
        random_.fill(grain, cv::RNG::NORMAL, 0, 3);
        cv::add(image, grain, image, cv::noArray(), CV_8U);
        if (index >= 20)
            cv::circle(image, middle(index), radius, {200, 40, 40}, cv::FILLED);
        return image;
    }
    [[nodiscard]] static cv::Point middle(int index) { return {20 + 2 * (index - 20), 60}; }
    [[nodiscard]] static cv::Rect2d box(int index)
    {
        return {middle(index).x - radius - 0.0, 60.0 - radius, 2 * radius + 1, 2 * radius + 1};
    }

private:
    static constexpr int radius = 12;
    cv::RNG random_{7};
};

}  // namespace

TEST_CASE("foreground: a moving disc is the only blob and lies where it was drawn, with both methods")
{
    for (const char* method : {"mog2", "knn"}) {
        CAPTURE(method);
        ForegroundFinder finder;
        finder.model.method = method;
        Clip clip;
        for (int index = 0; index < 60; ++index) {
            const Foreground found = finder.find(clip.frame(index));
            CHECK(found.learned == index + 1);
            CAPTURE(index);
            if (index < 20) {
                CHECK(found.blobs.empty());
                continue;
            }
            REQUIRE(found.blobs.size() == 1);
            CHECK(overlap::intersection_over_union(found.blobs[0].box, Clip::box(index)) > 0.8);
            CHECK(found.blobs[0].area == cv::countNonZero(found.mask == ForegroundFinder::foreground));
            CHECK(found.mask.at<unsigned char>(Clip::middle(index)) == 255);
        }
    }
}

TEST_CASE("foreground: in the first images of a model everything is background")
{
    for (const char* method : {"mog2", "knn"}) {
        ForegroundFinder finder;
        finder.model.method = method;
        Clip clip;
        for (int index = 30; index < 30 + ForegroundFinder::young; ++index) {
            const Foreground found = finder.find(clip.frame(index));
            CHECK(found.blobs.empty());
            CHECK(cv::countNonZero(found.mask) == 0);
        }
        CHECK_FALSE(finder.find(clip.frame(50)).blobs.empty());
    }
}

TEST_CASE("foreground: a change of model, size or channels restarts; one of the morphology does not")
{
    ForegroundFinder finder;
    Clip clip;
    const auto learned_after = [&](const auto& change) {
        for (int i = 0; i < 3; ++i)
            static_cast<void>(finder.find(clip.frame(i)));
        cv::Mat image = clip.frame(5);
        change(image);
        return finder.find(image).learned;
    };
    CHECK(learned_after([](cv::Mat&) {}) == 4);
    CHECK(learned_after([&](cv::Mat&) { finder.open = 2; }) == 8);
    CHECK(learned_after([&](cv::Mat&) { finder.min_area = 10; }) == 12);
    CHECK(learned_after([&](cv::Mat&) { finder.restart(); }) == 1);
    CHECK(learned_after([&](cv::Mat&) { finder.model.history = 50; }) == 1);
    CHECK(learned_after([&](cv::Mat&) { finder.model.threshold = 30; }) == 1);
    CHECK(learned_after([&](cv::Mat&) { finder.model.shadows = true; }) == 1);
    CHECK(learned_after([&](cv::Mat&) { finder.model.method = "knn"; }) == 1);
    CHECK(learned_after([](cv::Mat& image) { cv::resize(image, image, {80, 60}); }) == 1);
    CHECK(learned_after([](cv::Mat& image) { cv::cvtColor(image, image, cv::COLOR_BGR2GRAY); }) == 1);
}

TEST_CASE("foreground: shadows are marked only if requested, and belong to no blob")
{
    for (const bool shadows : {false, true}) {
        ForegroundFinder finder;
        finder.model.shadows = shadows;
        Clip clip;
        cv::Mat image;
        Foreground found;
        for (int index = 0; index < 20; ++index)
            found = finder.find(clip.frame(index));
        image = clip.frame(0);
        cv::Mat part = image(cv::Rect(40, 30, 60, 50));
        part.convertTo(part, -1, 0.7);
        found = finder.find(image);
        CAPTURE(shadows);
        CHECK((cv::countNonZero(found.mask == ForegroundFinder::shadow) > 2000) == shadows);
        CHECK(found.blobs.empty() == shadows);
    }
}

TEST_CASE("foreground: at most so many blobs, and those the largest; specks and small parts are left out")
{
    ForegroundFinder finder;
    finder.open = finder.close = 0;
    finder.min_area = 1;
    const cv::Mat wall(200, 400, CV_8UC1, cv::Scalar(100));
    cv::Mat dots = wall.clone();
    for (int i = 0; i < 300; ++i)
        dots(cv::Rect(i % 30 * 10, i / 30 * 10, i < 60 ? 1 : 2, 2)) = 250;
    for (int i = 0; i < 5; ++i)
        static_cast<void>(finder.find(wall));
    const Foreground found = finder.find(dots);
    CHECK(found.blobs.size() == ForegroundFinder::max_blobs);
    CHECK(std::ranges::count(found.blobs, 4, &background::Blob::area) == 240);
    CHECK(std::ranges::is_sorted(found.blobs, {},
                                 [](const background::Blob& blob) { return std::pair(blob.box.y, blob.box.x); }));
    finder.min_area = 3;
    CHECK(finder.find(dots).blobs.size() == 240);
    finder.open = 2;
    CHECK(finder.find(dots).blobs.empty());
}

TEST_CASE("foreground: when the light changes, what stands before the wall is still the only blob")
{
    for (const char* method : {"mog2", "knn"})
        for (const double gain : {0.5, 1.6}) {
            CAPTURE(std::string(method));
            CAPTURE(gain);
            ForegroundFinder finder;
            finder.model.method = method;
            Clip clip;
            int changes = 0;
            for (int index = 0; index < 70; ++index) {
                cv::Mat image = clip.frame(index);
                if (index >= 50)
                    image.convertTo(image, -1, gain);
                const Foreground found = finder.find(image);
                changes += found.light_changed ? 1 : 0;
                CHECK(found.light_changed == (index == 50));
                CAPTURE(index);
                if (index < 20)
                    continue;
                REQUIRE(found.blobs.size() == 1);
                CHECK(overlap::intersection_over_union(found.blobs[0].box, Clip::box(index)) > 0.75);
            }
            CHECK(changes == 1);
        }
}

TEST_CASE("foreground: with light=100 a change of the light is foreground")
{
    ForegroundFinder finder;
    finder.light = 100;
    Clip clip;
    for (int index = 0; index < 50; ++index)
        static_cast<void>(finder.find(clip.frame(index)));
    const Foreground found = finder.find(clip.frame(50) * 0.5);
    CHECK_FALSE(found.light_changed);
    CHECK(cv::countNonZero(found.mask) > 0.9 * static_cast<double>(found.mask.total()));
}

TEST_CASE("foreground: a large object of another colour is not a change of the light")
{
    ForegroundFinder finder;
    Clip clip;
    for (int index = 0; index < 50; ++index)
        static_cast<void>(finder.find(clip.frame(index)));
    cv::Mat image = clip.frame(0);
    image(cv::Rect(10, 10, 140, 100)) = cv::Scalar(200, 40, 40);
    const Foreground found = finder.find(image);
    CHECK_FALSE(found.light_changed);
    REQUIRE(found.blobs.size() == 1);
    CHECK(found.blobs[0].area > 12'000);
}

TEST_CASE("foreground: a change of the light is seen soon after a large thing that was none, and long after")
{
    for (const int later : {1, 30}) {
        CAPTURE(later);
        ForegroundFinder finder;
        Clip clip;
        for (int index = 0; index < 50; ++index)
            static_cast<void>(finder.find(clip.frame(index)));
        cv::Mat image = clip.frame(0);
        image(cv::Rect(10, 10, 140, 100)) = cv::Scalar(200, 40, 40);
        CHECK_FALSE(finder.find(image).light_changed);
        for (int index = 1; index < later; ++index)
            CHECK_FALSE(finder.find(clip.frame(50 + index)).light_changed);
        CHECK(finder.find(clip.frame(50 + later) * 0.5).light_changed);
        CHECK_FALSE(finder.find(clip.frame(51 + later) * 0.5).light_changed);
    }
}

TEST_CASE("foreground: an unknown method is refused")
{
    ForegroundFinder finder;
    finder.model.method = "magic";
    CHECK_THROWS_AS(static_cast<void>(finder.find(Clip().frame(0))), std::invalid_argument);
}

TEST_CASE("foreground: on the clip of two blobs the mask is the true one (needs media)")
{
    const auto clip = media::shared("media/bgs_two_blobs_brick.mp4"),
               truth = media::shared("media/bgs_two_blobs_brick_mask.avi");
    if (!clip || !truth)
        return;
    for (const char* method : {"mog2", "knn"}) {
        ForegroundFinder finder;
        finder.model.method = method;
        cv::VideoCapture video(clip->string()), masks(truth->string());
        cv::Mat image, mask;
        double both = 0, either = 0;
        while (video.read(image) && masks.read(mask)) {
            const Foreground found = finder.find(image);
            if (found.learned <= 30)
                continue;
            cv::extractChannel(mask, mask, 0);
            const cv::Mat expected = mask > 127;
            both += cv::countNonZero(found.mask & expected);
            either += cv::countNonZero(found.mask | expected);
        }
        MESSAGE(std::string(method), ": IoU of the masks ", both / either);
        CHECK(both / either > 0.9);
    }
}
