// The face finder: the same boxes as a plain OpenCV program, and the faces that are there.
#include "media.hpp"
#include "overlap.hpp"

#include <doctest/doctest.h>
#include <face_finder.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <algorithm>
#include <map>
#include <tuple>

using face::FaceFinder;

namespace {

auto order(const cv::Rect& box) { return std::tuple(box.y, box.x, box.height, box.width); }

/// The same without Hive.
std::vector<cv::Rect> plain_faces(const cv::Mat& image, double scale, int neighbors, int min_size)
{
    static cv::CascadeClassifier cascade(face::default_cascade);
    cv::Mat grey;
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    std::vector<cv::Rect> boxes;
    cascade.detectMultiScale(grey, boxes, scale, neighbors, 0, {min_size, min_size});
    std::ranges::sort(boxes, {}, order);
    return boxes;
}

FaceFinder loaded_finder()
{
    FaceFinder finder;
    finder.load(face::default_cascade);
    return finder;
}

}  // namespace

TEST_CASE("face finder: on the photographs it gives the boxes of a plain OpenCV program (needs media)")
{
    FaceFinder finder = loaded_finder();
    for (const auto& path : media::images({".jpg", ".png"})) {
        CAPTURE(path.filename().string());
        const cv::Mat image = cv::imdecode(media::read(path), cv::IMREAD_COLOR);
        CHECK(finder.find(image) == plain_faces(image, 1.1, 5, 24));
    }
}

TEST_CASE("face finder: with other parameters it still gives the boxes of a plain OpenCV program (needs media)")
{
    FaceFinder finder = loaded_finder();
    finder.scale = 1.25;
    finder.min_neighbors = 3;
    finder.min_size = 40;
    for (const char* name : {"media/faces_2008_001322.jpg", "media/messi5.jpg", "media/astronaut.png"})
        if (const auto path = media::shared(name)) {
            const cv::Mat image = cv::imdecode(media::read(*path), cv::IMREAD_COLOR);
            CHECK(finder.find(image) == plain_faces(image, 1.25, 3, 40));
        }
}

TEST_CASE("face finder: the known faces of the photographs are found (needs media)")
{
    struct Case {
        const char* name;
        cv::Rect2d box;
    };
    FaceFinder finder = loaded_finder();
    for (const Case& known : {Case{"astronaut.png", {177, 66, 95, 95}},
                              {"grace_hopper_512x512.jpg", {153, 85, 228, 228}},
                              {"messi5.jpg", {226, 94, 38, 38}},
                              {"chessboard_man.jpg", {135, 215, 57, 57}}})
        if (const auto path = media::shared(std::string("media/") + known.name)) {
            overlap::Score score;
            score.add(finder.find(cv::imread(path->string())), {known.box}, 0.9);
            CAPTURE(std::string(known.name));
            CHECK(score.hits == 1);
        }
}

TEST_CASE("face finder: 13 of the 18 faces of the group images are found, and no other (needs media)")
{
    using Boxes = std::vector<cv::Rect2d>;
    const std::map<std::string, Boxes> groups{
        {"faces_2007_007763.jpg",
         {{194, 90, 37, 37},
          {158, 114, 37, 37},
          {381, 89, 45, 44},
          {94, 198, 37, 37},
          {178, 214, 37, 37},
          {294, 86, 37, 37},
          {309, 233, 45, 44}}},
        {"faces_2008_002079.jpg",
         {{407, 166, 37, 37},
          {122, 134, 37, 37},
          {346, 138, 37, 37},
          {433, 171, 53, 52},
          {62, 134, 37, 37},
          {41, 194, 44, 44}}},
        {"faces_2008_001009.jpg", {{145, 79, 76, 76}, {125, 214, 90, 91}}},
        {"faces_2008_001322.jpg", {{104, 162, 76, 76}, {232, 218, 63, 63}, {344, 155, 90, 90}}}};
    if (!media::shared("media/faces_2008_001322.jpg"))
        return;
    FaceFinder finder = loaded_finder();
    overlap::Score score;
    for (const auto& [name, boxes] : groups)
        score.add(finder.find(cv::imread(media::shared("media/" + name)->string())), boxes, 0.3);
    CHECK(score.hits == 13);
    CHECK(score.false_alarms == 0);
}

TEST_CASE("face finder: the face over the wall is found in every image, where a plain OpenCV program finds it (needs "
          "media)")
{
    const auto video = media::shared("media/face_over_brick.mp4");
    if (!video)
        return;
    const auto truth = media::ground_truth(*media::shared("media/face_over_brick.gt.csv"));
    FaceFinder finder = loaded_finder();
    cv::VideoCapture capture(video->string(), cv::CAP_FFMPEG);
    cv::Mat image;
    overlap::Score score;
    for (int frame = 1; capture.read(image); ++frame) {
        if (frame % 3 != 0)  // every image would take 20 s
            continue;
        const auto found = finder.find(image);
        CHECK(found == plain_faces(image, 1.1, 5, 24));
        score.add(found, media::boxes(truth.at(frame)), 0.5);
    }
    CHECK(score.hits == 40);
    CHECK(score.misses == 0);
    CHECK(score.false_alarms == 0);
}

TEST_CASE("face finder: a largest size leaves out what is larger, and the image is not changed (needs media)")
{
    const auto path = media::shared("media/astronaut.png");
    if (!path)
        return;
    FaceFinder finder = loaded_finder();
    const cv::Mat image = cv::imread(path->string()), before = image.clone();
    finder.max_size = 60;
    finder.equalise = true;
    for (const cv::Rect& box : finder.find(image))
        CHECK(box.width <= 60);
    CHECK(media::same(image, before));
}

TEST_CASE("face finder: draw frames the box and nothing else")
{
    cv::Mat image(100, 100, CV_8UC3, cv::Scalar::all(0));
    FaceFinder::draw(image, {{20, 30, 40, 50}});
    CHECK(image.at<cv::Vec3b>(30, 40) == cv::Vec3b(60, 220, 60));
    CHECK(image.at<cv::Vec3b>(50, 40) == cv::Vec3b(0, 0, 0));
    CHECK(image.at<cv::Vec3b>(50, 90) == cv::Vec3b(0, 0, 0));
}

TEST_CASE("face finder: a missing or invalid cascade is refused and the old one stays")
{
    const media::Folder folder;
    media::write(folder.path() / "c.xml", {'<', 'x', '/', '>'});
    FaceFinder finder = loaded_finder();
    CHECK_THROWS_WITH(finder.load("/nowhere.xml"), doctest::Contains("/nowhere.xml"));
    CHECK_THROWS_WITH(finder.load((folder.path() / "c.xml").string()), doctest::Contains("not a cascade"));
    CHECK_NOTHROW(static_cast<void>(finder.find(cv::Mat(50, 50, CV_8UC1, cv::Scalar(0)))));
}
