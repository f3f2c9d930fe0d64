// The walkers of the scene: their truth is true, their ids last, and a background subtractor sees them.
#include "media.hpp"
#include "overlap.hpp"

#include <doctest/doctest.h>
#include <opencv2/core.hpp>
#include <scene.hpp>

#include <map>
#include <set>

using camera::Scene;
using camera::SceneSettings;

namespace {

SceneSettings with_walkers(int walkers, cv::Size size = {640, 480})
{
    SceneSettings settings;
    settings.size = size;
    settings.faces = 0;
    settings.walkers = walkers;
    settings.noise = 0;
    return settings;
}

/// 255 where two frames differ clearly.
cv::Mat differing(const cv::Mat& a, const cv::Mat& b)
{
    cv::Mat difference, channels[3];
    cv::absdiff(a, b, difference);
    cv::split(difference, channels);
    return cv::max(channels[0], cv::max(channels[1], channels[2])) > 25;
}

}  // namespace

TEST_CASE("walkers: what differs from the empty scene lies in the boxes of the walkers (but for swinging hands and "
          "feet), and fills them")
{
    for (const cv::Size size : {cv::Size(640, 480), cv::Size(320, 240)}) {
        const Scene scene(with_walkers(4, size)), empty(with_walkers(0, size));
        const cv::Mat wall = empty.frame(0).image;
        for (int index = 0; index < 700; index += 23) {
            const auto [image, truth, hands] = scene.frame(index);
            cv::Mat drawn = differing(image, wall);
            CAPTURE(index);
            for (const auto& [kind, id, box] : truth) {
                CHECK(kind == "walker");
                CHECK((box & cv::Rect2d({}, cv::Size2d(size))) == box);
                CHECK(cv::countNonZero(drawn(cv::Rect(box))) > 0.25 * box.area());
            }
            // Those that are hardly in the image yet are not told; everything else is, but for swinging hands and
            // feet.
            drawn.colRange(0, size.width / 10).setTo(0);
            drawn.colRange(size.width - size.width / 10, size.width).setTo(0);
            const int all = cv::countNonZero(drawn);
            for (const auto& one : truth)
                drawn((cv::Rect(one.box) + cv::Size(2, 2)) & cv::Rect({}, size)).setTo(0);
            CHECK(cv::countNonZero(drawn) <= 0.06 * all);
        }
    }
}

TEST_CASE("walkers: the first second is empty; then each walker crosses once, evenly, with its own id")
{
    const Scene scene(with_walkers(4));
    std::map<int, std::vector<std::pair<int, double>>> ways;  // id to image and middle
    for (int index = 0; index < 1500; ++index) {
        const auto truth = scene.frame(index).truth;
        CHECK((index >= 30 || truth.empty()));
        std::set<int> ids;
        for (const auto& [kind, id, box] : truth) {
            CHECK(ids.insert(id).second);
            if (box.x > 0 && box.x + box.width < 640)
                ways[id].emplace_back(index, box.x + box.width / 2);
        }
    }
    CHECK(ways.size() >= 20);
    std::set<long> speeds;
    for (const auto& [id, way] : ways) {
        const double speed = (way.back().second - way.front().second) / (way.back().first - way.front().first);
        speeds.insert(std::lround(speed * 100));
        for (const auto& [index, middle] : way)
            CHECK(middle == doctest::Approx(way.front().second + speed * (index - way.front().first)).epsilon(0.001));
    }
    CHECK(speeds.size() == 4);
    CHECK(*speeds.begin() < 0);
    CHECK(*speeds.rbegin() > 0);
}

TEST_CASE("walkers: the same arguments give the same people, another seed gives others")
{
    SceneSettings other = with_walkers(3);
    other.seed = 2;
    CHECK(Scene(with_walkers(3)).frame(200).truth == Scene(with_walkers(3)).frame(200).truth);
    CHECK_FALSE(Scene(with_walkers(3)).frame(200).truth == Scene(other).frame(200).truth);
    CHECK_THROWS(Scene(with_walkers(5)));
    CHECK_THROWS(Scene(with_walkers(-1)));
}

TEST_CASE("walkers: a walker is in the ground truth while half of it is in the image")
{
    const auto part = [](double middle) { return camera::visible_box({middle, 100, 200, 0}, {640, 480}); };
    CHECK_FALSE(part(-1));
    REQUIRE(part(1));
    CHECK(part(1)->x == 0);
    CHECK(part(1)->width == doctest::Approx(35));
    CHECK(part(300)->width == doctest::Approx(68));
    CHECK_FALSE(part(641));
}
