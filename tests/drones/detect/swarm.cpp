// The detect drone with real processes: the results of plain OpenCV in the same images, and models that are refused.
#include "onnx_writer.hpp"
#include "page.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <people_finder.hpp>

#include <opencv2/core/utility.hpp>
#include <opencv2/videoio.hpp>

#include <fstream>

using namespace hive::test;
using hive::Json;

TEST_CASE("detect: on filmed walkers, on demand, the drone finds in each image what a plain program with the same "
          "class finds")
{
    const auto video = shared_data("media/pedestrians_0001-0400.avi");
    if (!possible(video ? "" : "the videos in the folder that HIVE_SHARED names"))
        return;
    constexpr int images = sanitized() ? 2 : 6;
    cv::setNumThreads(1);
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=" + video->string(), "pace=demand"});
    const auto detect = swarm.drone("detect", "detect", {"enlarge=2"});
    auto application = swarm.application();
    const auto collector = application.collect({{"detect", "objects"}});
    application.connect({"camera", ""}, {"detect", ""});
    cv::VideoCapture capture(video->string(), cv::CAP_FFMPEG);
    detect::PeopleFinder finder;
    finder.enlarge = 2;
    std::size_t found = 0;
    for (int index = 0; index < images; ++index) {
        cv::Mat image;
        REQUIRE(capture.read(image));
        const auto result = collector->next(patient(Milliseconds(20'000)));
        REQUIRE(result);
        const Json& objects = result->header.at("objects");
        CHECK(own_keys(result->header) == keys(json_example("detect")));
        const auto people = finder.find(image);
        REQUIRE(objects.size() == people.size());
        for (std::size_t i = 0; i < people.size(); ++i) {
            CHECK(keys(objects[i]) == keys(json_example("detect").at("objects").at(0)));
            CHECK(objects[i].at("x") == people[i].box.x);
            CHECK(objects[i].at("y") == people[i].box.y);
            CHECK(objects[i].at("w") == people[i].box.width);
            CHECK(objects[i].at("h") == people[i].box.height);
            CHECK(objects[i].at("class") == "person");
            CHECK(objects[i].at("score").get<double>() == doctest::Approx(people[i].score).epsilon(0.001));
        }
        found += people.size();
    }
    CHECK(found > 0);
}

TEST_CASE("detect: a model or a file of classes that cannot be used is refused in a sentence, by set and at the start, "
          "and people are found as before")
{
    const Swarm swarm;
    const auto garbage = (swarm.home() / "garbage.onnx").string();
    std::ofstream(garbage) << "this is no model";
    const auto detect = swarm.drone("detect", "detect");
    const auto refused = [&](const std::string& setting, const std::string& sentence) {
        const auto finished = swarm.hivectl({"set", "detect", setting});
        CHECK(finished.exit_code != 0);
        CHECK_MESSAGE(finished.err.find(sentence) != std::string::npos, finished.err);
    };
    refused("model=/nowhere/model.onnx", "no model at /nowhere/model.onnx");
    refused("model=" + garbage, "is not an ONNX model that OpenCV's DNN can read");
    refused("classes=/nowhere/names", "no file of class names at /nowhere/names");
    refused("mean=1,2", "mean is one number, or three");
    refused("stride=6", "stride is a multiple of 4");
    auto application = swarm.application();
    CHECK(application.status("detect").state == hive::State::idle);
    CHECK(swarm.hivectl_done({"get", "detect", "model"}).find("/nowhere") == std::string::npos);
    const auto not_started = [&](const std::string& setting, const std::string& sentence) {
        const auto started = swarm.run({swarm.program("hive-detect").string(), "--name", "other", "--set", setting});
        CHECK(started.exit_code != 0);
        CHECK_MESSAGE(started.err.find(sentence) != std::string::npos, started.err);
    };
    not_started("model=" + garbage, "is not an ONNX model");
    not_started("classes=/nowhere/names", "no file of class names at /nowhere/names");
}

TEST_CASE("detect: a model that is set while images come is used, with the names of its classes, and people again "
          "without it")
{
    const Swarm swarm;
    // Always one cup in the left half of the image.
    const onnx::File model(
        ".onnx", onnx::bytes_of({.shape = {1, 1, 1, 7}, .constants = {0, 1, 0.75F, 0, 0, 0.5F, 1}, .wires = {}})),
        names(".names", "background\ncup\n");
    const auto camera = swarm.drone("camera", "camera", {"source=scene:plain", "faces=0"});
    const auto detect = swarm.drone("detect", "detect");
    auto application = swarm.application();
    const auto collector = application.collect({{"detect", "objects"}});
    application.connect({"camera", ""}, {"detect", ""});
    const auto comes = [&](const Json& objects) {
        return eventually(
            [&] {
                const auto result = collector->next(Milliseconds(200));
                if (!result)
                    return false;
                Json found = result->header.at("objects");
                for (Json& one : found)
                    CHECK(one.erase("colours") == 1);  // those of the scene, which another test checks
                return found == objects;
            },
            Milliseconds(10'000));
    };
    CHECK(comes(Json::array()));
    swarm.hivectl_done({"set", "detect", "model=" + model.path(), "classes=" + names.path(), "input_width=8",
                        "input_height=8", "fit=stretch"});
    CHECK(comes({{{"x", 0}, {"y", 0}, {"w", 320}, {"h", 480}, {"class", "cup"}, {"score", 0.75}}}));
    swarm.hivectl_done({"set", "detect", "model="});
    CHECK(comes(Json::array()));
}

TEST_CASE("detect: more keypoints than an event holds leave out the weakest objects")
{
    const Swarm swarm;
    constexpr int people = 300, numbers = 57;
    std::vector<float> rows;
    for (int i = 0; i < people; ++i) {
        const float x = static_cast<float>(i % 20), y = static_cast<float>(i / 20);  // none overlaps another
        rows.insert(rows.end(), {x, y, x + 0.9F, y + 0.9F, 0.99F - 0.001F * static_cast<float>(i), 0});
        rows.resize(static_cast<std::size_t>((i + 1) * numbers), 10.0F);
    }
    onnx::Model person{.width = 20, .height = 15, .shape = {1, people, numbers}, .constants = rows, .wires = {}};
    person.metadata = {{"names", "{0: 'person'}"}, {"task", "pose"}, {"kpt_shape", "[17, 3]"}};
    for (std::size_t i = 8; i < rows.size(); ++i)
        if (i % numbers >= 8 && (i % numbers - 8) % 3 == 0)
            person.constants[i] = 0.5F;
    const onnx::File model(".onnx", onnx::bytes_of(person));
    const auto camera = swarm.drone("camera", "camera", {"source=scene:plain", "faces=0"});
    const auto detect = swarm.drone("detect", "detect", {"model=" + model.path()});
    auto application = swarm.application();
    const auto collector = application.collect({{"detect", "objects"}});
    application.connect({"camera", ""}, {"detect", ""});
    const auto result = collector->next(patient(Milliseconds(20'000)));
    REQUIRE(result);
    const Json& objects = result->header.at("objects");
    CHECK(objects.size() > 50);
    CHECK(objects.size() < people);
    CHECK(objects.at(0).at("score") == 0.99);
    CHECK(objects.at(0).at("keypoints").size() == 17);
    CHECK(objects.at(0).at("keypoints").at(0) == Json({320, 320, 0.5}));
}
