// The people finder: the windows of a plain OpenCV program, and the walkers that are there.
#include "media.hpp"

#include <background.hpp>
#include <doctest/doctest.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <people_finder.hpp>

#include <algorithm>
#include <cmath>
#include <map>

using detect::Object;
using detect::PeopleFinder;

namespace {

/// A walker of height H with the top of the head at `top`, drawn from lines and ellipses; `phase` of the step.
class Walker {
public:
    Walker(cv::Mat& image, cv::Point2d top, double height, double phase) : image_(image), top_(top), height_(height)
    {
        const double step = 0.10 * std::sin(phase);
        for (const int side : {-1, 1})
            leg_and_arm(side, step);
        cv::ellipse(image_, at(0, 0.34), size(0.105, 0.19), 0, 0, 360, clothes, cv::FILLED, cv::LINE_AA);
        line({-0.075, 0.205}, {0.075, 0.205}, 0.06, clothes);
        line({0, 0.14}, {0, 0.18}, 0.06, {110, 130, 165});
        cv::ellipse(image_, at(0, 0.08), size(0.058, 0.078), 0, 0, 360, {125, 150, 190}, cv::FILLED, cv::LINE_AA);
        cv::ellipse(image_, at(0, 0.055), size(0.06, 0.055), 0, 180, 360, {30, 32, 38}, cv::FILLED, cv::LINE_AA);
    }

    [[nodiscard]] cv::Rect2d box() const { return {top_.x - 0.17 * height_, top_.y, 0.34 * height_, height_}; }

private:
    static inline const cv::Scalar clothes{75, 62, 60};

    void leg_and_arm(int side, double step)
    {
        const cv::Scalar trousers = side < 0 ? cv::Scalar(45, 40, 38) : cv::Scalar(52, 46, 42), sleeve(70, 60, 60);
        const cv::Point2d knee(side * (0.04 + step / 2), 0.74), foot(side * (0.045 + step), 0.97);
        line({0.035 * side, 0.50}, knee, 0.075, trousers);
        line(knee, foot, 0.06, trousers);
        line(foot, foot + cv::Point2d(0.03, 0), 0.04, {25, 25, 25});
        const cv::Point2d elbow(side * (0.115 - step / 2), 0.36);
        line({0.10 * side, 0.21}, elbow, 0.05, sleeve);
        line(elbow, {side * (0.11 - step), 0.50}, 0.042, sleeve);
    }

    [[nodiscard]] cv::Point at(double x, double y) const
    {
        return {cvRound(top_.x + x * height_), cvRound(top_.y + y * height_)};
    }
    [[nodiscard]] cv::Size size(double x, double y) const { return {cvRound(x * height_), cvRound(y * height_)}; }
    void line(cv::Point2d from, cv::Point2d to, double thickness, const cv::Scalar& colour)
    {
        cv::line(image_, at(from.x, from.y), at(to.x, to.y), colour, std::max(1, cvRound(thickness * height_)),
                 cv::LINE_AA);
    }

    cv::Mat& image_;
    cv::Point2d top_;
    double height_;
};

struct Scene {
    cv::Mat image;
    std::vector<cv::Rect2d> truth;
};

/// Two walkers before a brick wall, at the `index`th moment.
Scene walkers(int index)
{
    Scene scene{camera::draw_background(camera::Background::brick, {640, 480}, 1), {}};
    cv::RNG random(static_cast<std::uint64_t>(index) + 1);
    for (const double x : {130.0 + 9 * index, 500.0 - 7 * index}) {
        const Walker walker(scene.image, {x, 90.0 + 4 * index}, 170 + 5 * index, 0.7 * index);
        scene.truth.push_back(walker.box());
    }
    cv::Mat noise(scene.image.size(), CV_16SC3);
    random.fill(noise, cv::RNG::NORMAL, 0, 3);
    cv::add(scene.image, noise, scene.image, cv::noArray(), CV_8U);
    return scene;
}

double overlap(const cv::Rect2d& a, const cv::Rect2d& b)
{
    const double both = (a & b).area();
    return both / (a.area() + b.area() - both);
}

int hits(const std::vector<Object>& found, const std::vector<cv::Rect2d>& truth, double enough)
{
    return static_cast<int>(std::ranges::count_if(truth, [&](const cv::Rect2d& box) {
        return std::ranges::any_of(found, [&](const Object& object) { return overlap(object.box, box) >= enough; });
    }));
}

/// The same without Hive, best first.
std::vector<std::pair<double, cv::Rect>> plain_people(const cv::Mat& image)
{
    static const cv::HOGDescriptor descriptor = [] {
        cv::HOGDescriptor made;
        made.setSVMDetector(cv::HOGDescriptor::getDefaultPeopleDetector());
        return made;
    }();
    std::vector<cv::Rect> boxes;
    std::vector<double> weights;
    descriptor.detectMultiScale(image, boxes, weights, 0, {8, 8}, {16, 16}, 1.05, 2);
    std::vector<std::pair<double, cv::Rect>> people;
    for (std::size_t i = 0; i < boxes.size(); ++i)
        people.emplace_back(weights[i], boxes[i] & cv::Rect({}, image.size()));
    return people;
}

bool same(const std::vector<Object>& found, const std::vector<std::pair<double, cv::Rect>>& plain)
{
    return found.size() == plain.size() && std::ranges::all_of(plain, [&](const auto& person) {
               return std::ranges::any_of(found, [&](const Object& object) {
                   return object.box == person.second && object.score == person.first;
               });
           });
}

}  // namespace

TEST_CASE("people finder: on drawn walkers it finds the windows of a plain OpenCV program, and the walkers in them")
{
    PeopleFinder finder;
    int found = 0, all = 0;
    for (int index = 0; index < 10; ++index) {
        const Scene scene = walkers(index);
        finder.shrink = false;
        CHECK(same(finder.find(scene.image), plain_people(scene.image)));
        finder.shrink = true;
        found += hits(finder.find(scene.image), scene.truth, 0.5);
        all += static_cast<int>(scene.truth.size());
    }
    MESSAGE(found, " of ", all, " walkers found");
    CHECK(found >= all - 1);
}

TEST_CASE("people finder: on filmed walkers it finds the windows of a plain OpenCV program, and most of the walkers "
          "(needs media)")
{
    const auto video = media::shared("media/pedestrians_0001-0400.avi");
    if (!video)
        return;
    const auto truth = media::ground_truth(video->parent_path() / "pedestrians_0001-0400.gt.csv");
    cv::VideoCapture capture(video->string(), cv::CAP_FFMPEG);
    PeopleFinder finder;
    finder.shrink = false;
    cv::Mat image;
    int found = 0, found_as_it_is = 0, all = 0;
    for (int frame = 1; frame <= 400 && capture.read(image); ++frame) {
        if (frame % 80 != 0)
            continue;
        CHECK(same(finder.find(image), plain_people(image)));
        PeopleFinder fitting;
        found_as_it_is += hits(fitting.find(image), media::boxes(truth.at(frame)), 0.5);
        fitting.enlarge = 2;  // they are about 80 px high
        found += hits(fitting.find(image), media::boxes(truth.at(frame)), 0.5);
        all += static_cast<int>(truth.at(frame).size());
    }
    MESSAGE(found, " of ", all, " filmed walkers found, ", found_as_it_is, " without enlarging");
    CHECK(all > 20);
    CHECK(found * 2 > all);
}

TEST_CASE("people finder: an empty wall, a tiny image and a grey one are looked at; the image is not changed")
{
    PeopleFinder finder;
    CHECK(finder.find(cv::Mat(480, 640, CV_8UC3, cv::Scalar(165, 165, 160))).empty());
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(20, 400), cv::Size(63, 127)})
        CHECK_NOTHROW(static_cast<void>(finder.find(cv::Mat(size, CV_8UC3, cv::Scalar::all(9)))));
    const Scene scene = walkers(2);
    cv::Mat grey;
    cv::cvtColor(scene.image, grey, cv::COLOR_BGR2GRAY);
    const cv::Mat before = grey.clone();
    CHECK(hits(finder.find(grey), scene.truth, 0.5) == 2);
    CHECK(cv::norm(grey, before, cv::NORM_INF) == 0);
}

TEST_CASE("people finder: a higher threshold leaves out the weaker ones, and the best comes first")
{
    const Scene scene = walkers(4);
    PeopleFinder finder;
    const auto all = finder.find(scene.image);
    REQUIRE(all.size() >= 2);
    CHECK(std::ranges::is_sorted(all, std::ranges::greater{}, &Object::score));
    finder.hit_threshold = 100;
    CHECK(finder.find(scene.image).empty());
    finder.hit_threshold = -3;
    finder.grouping = 0;
    const auto too_many = finder.find(scene.image);
    CHECK(too_many.size() == detect::max_objects);
    CHECK(too_many.front().score >= all.front().score);
}

TEST_CASE("object: draw frames the box and nothing far from it")
{
    cv::Mat image = cv::Mat::zeros(200, 200, CV_8UC3);
    detect::draw(image, {{{20, 30, 40, 50}, "cup", 0.9}});
    CHECK(image.at<cv::Vec3b>(80, 40)[1] > 200);
    CHECK(cv::countNonZero(image.rowRange(120, 200).clone().reshape(1)) == 0);
}
