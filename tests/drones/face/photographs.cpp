// Real photographs through a real swarm: the face drone finds what a plain OpenCV program with the same parameters
// finds.
#include "swarm.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include <algorithm>
#include <array>
#include <set>

using namespace hive::test;

namespace {

/// x, y, w, h
using Boxes = std::set<std::array<int, 4>>;

Boxes plain_opencv(const std::filesystem::path& photograph)
{
    cv::CascadeClassifier cascade("/usr/share/opencv4/haarcascades/haarcascade_frontalface_default.xml");
    cv::Mat grey;
    cv::cvtColor(cv::imread(photograph.string()), grey, cv::COLOR_BGR2GRAY);
    std::vector<cv::Rect> faces;
    cascade.detectMultiScale(grey, faces, 1.1, 5, 0, {24, 24});
    Boxes boxes;
    for (const auto& face : faces)
        boxes.insert({face.x, face.y, face.width, face.height});
    return boxes;
}

Boxes boxes_in(const hive::Json& header)
{
    Boxes boxes;
    for (const auto& face : header.at("faces"))
        boxes.insert(std::array{face.at("x").get<int>(), face.at("y").get<int>(), face.at("w").get<int>(),
                                face.at("h").get<int>()});
    return boxes;
}

std::vector<std::filesystem::path> photographs(const std::filesystem::path& folder)
{
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".jpg" || entry.path().extension() == ".png")
            files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

}  // namespace

TEST_CASE("photographs: the face drone at its defaults finds in each exactly the boxes of a plain OpenCV program")
{
    const auto media = shared_data("media");
    if (!possible(media ? "" : "the photographs in the folder that HIVE_SHARED names"))
        return;
    cv::setNumThreads(1);
    const auto files = photographs(*media);
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=" + media->string(), "pace=demand", "loop=off"});
    const auto face = swarm.drone("face", "face");
    auto application = swarm.application();
    const auto collector = application.collect({{"face", "faces"}});
    application.connect({"camera", ""}, {"face", ""});
    std::size_t found = 0;
    for (const auto& file : files) {
        const auto result = collector->next(Milliseconds(60'000));
        REQUIRE_MESSAGE(result, file.filename().string());
        CHECK_MESSAGE(boxes_in(result->header) == plain_opencv(file), file.filename().string());
        found += result->header.at("faces").size();
    }
    MESSAGE(files.size(), " photographs, ", found, " faces");
    CHECK(found >= 17);  // as the index of the photographs lists
}
