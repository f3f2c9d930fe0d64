// The synthetic scene: its ground truth is correct, and real detectors find its objects.
#include "drawn_face.hpp"
#include "media.hpp"
#include "overlap.hpp"
#include "scene.hpp"

#include <doctest/doctest.h>
#include <face_finder.hpp>
#include <opencv2/core.hpp>

using camera::Background;
using camera::Scene;
using camera::SceneSettings;

namespace {

SceneSettings settings(cv::Size size, Background background, int faces)
{
    SceneSettings result;
    result.size = size;
    result.background = background;
    result.faces = faces;
    return result;
}

std::vector<cv::Rect2d> boxes_of(const std::vector<camera::Truth>& truth)
{
    std::vector<cv::Rect2d> boxes;
    for (const camera::Truth& one : truth)
        boxes.push_back(one.box);
    return boxes;
}

}  // namespace

TEST_CASE("scene: an image depends on the settings and its index alone")
{
    const SceneSettings same = settings({320, 240}, Background::noise, 2);
    const Scene one(same), other(same);
    static_cast<void>(other.frame(3));
    CHECK(media::same(one.frame(7).image, other.frame(7).image));
    CHECK(one.frame(7).truth == other.frame(7).truth);
    CHECK_FALSE(media::same(one.frame(7).image, one.frame(8).image));
    SceneSettings reseeded = same;
    reseeded.seed = 2;
    CHECK_FALSE(media::same(one.frame(7).image, Scene(reseeded).frame(7).image));
}

TEST_CASE("scene: faces stay inside with hair and chin, and never meet")
{
    for (const cv::Size size : {cv::Size(64, 64), cv::Size(640, 480), cv::Size(480, 640), cv::Size(1280, 720)})
        for (int faces = 1; faces <= 3; ++faces) {
            SceneSettings still = settings(size, Background::plain, faces);
            still.noise = 0;
            const Scene scene(still);
            for (int index = 0; index < 600; index += 7) {
                const auto truth = scene.frame(index).truth;
                REQUIRE(truth.size() == static_cast<std::size_t>(faces));
                for (std::size_t i = 0; i < truth.size(); ++i) {
                    const cv::Rect2d box = truth[i].box;
                    CHECK(box.x >= 0);
                    CHECK(box.x + box.width <= size.width + 1e-9);
                    CHECK(box.y >= 0.25 * box.height - 1e-9);
                    CHECK(box.y + 1.1 * box.height <= size.height + 1e-9);
                    if (i > 0)
                        CHECK((box & truth[i - 1].box).area() == 0);
                }
            }
        }
}

TEST_CASE("scene: the noise has the configured deviation, and differs in each image")
{
    SceneSettings still = settings({320, 240}, Background::plain, 0);
    still.noise = 6;
    const Scene scene(still);
    cv::Scalar mean, deviation;
    cv::meanStdDev(scene.frame(1).image, mean, deviation);
    CHECK(mean[0] == doctest::Approx(130).epsilon(0.01));
    CHECK(deviation[0] == doctest::Approx(6).epsilon(0.05));
    cv::Mat difference;
    cv::subtract(scene.frame(1).image, scene.frame(2).image, difference, cv::noArray(), CV_16S);
    cv::meanStdDev(difference, mean, deviation);
    CHECK(deviation[1] == doctest::Approx(6 * 1.4142).epsilon(0.05));
}

TEST_CASE("scene: drawing outside the image is cut off, not written")
{
    cv::Mat guarded(60, 60, CV_8UC3, cv::Scalar::all(9));
    cv::Mat inner = guarded(cv::Rect(20, 20, 20, 20));
    for (const cv::Rect2d box : {cv::Rect2d(-30, -30, 40, 40), cv::Rect2d(5, 5, 300, 300), cv::Rect2d(90, 90, 30, 30)})
        camera::draw_face(inner, box);
    CHECK(cv::norm(guarded.rowRange(0, 20), cv::Mat(20, 60, CV_8UC3, cv::Scalar::all(9)), cv::NORM_INF) == 0);
    CHECK(cv::norm(guarded.colRange(40, 60), cv::Mat(60, 20, CV_8UC3, cv::Scalar::all(9)), cv::NORM_INF) == 0);
}

TEST_CASE("scene: what it cannot be is refused")
{
    CHECK_THROWS(Scene(settings({63, 480}, Background::brick, 1)));
    CHECK_THROWS(Scene(settings({640, 480}, Background::brick, 4)));
}

TEST_CASE("scene: a face finder finds 99 of 100 faces and hardly anything else")
{
    struct Case {
        cv::Size size;
        Background background;
        int faces;
    };
#ifdef HIVE_SANITIZED
    constexpr int images = 25;
#else
    constexpr int images = 100;
#endif
    face::FaceFinder finder;
    finder.load(face::default_cascade);
    for (const Case& seen : {Case{{640, 480}, Background::brick, 1},
                             {{320, 240}, Background::noise, 1},
                             {{640, 480}, Background::plain, 3}}) {
        const Scene scene(settings(seen.size, seen.background, seen.faces));
        overlap::Score score;
        for (int index = 0; index < images; ++index) {
            const auto image = scene.frame(index * 5);
            score.add(finder.find(image.image), boxes_of(image.truth), 0.5);
        }
        CAPTURE(static_cast<int>(seen.background));
        CHECK(score.hits * 100 >= 99 * images * seen.faces);
        CHECK(score.false_alarms <= 2);
    }
}
