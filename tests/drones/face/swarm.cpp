// The face swarm from camera to shell: boxes where the faces were drawn, and an image with the boxes.
#include "measure.hpp"
#include "media.hpp"
#include "status_sums.hpp"
#include "yunet_model.hpp"

#include <doctest/doctest.h>

#include <opencv2/core/mat.hpp>

#include <map>
#include <sstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

double overlap(const Json& a, const Json& b)
{
    const auto of = [](const Json& box, const char* key) { return box.at(key).get<double>(); };
    const auto common = [&](const char* place, const char* length) {
        return std::max(0.0, std::min(of(a, place) + of(a, length), of(b, place) + of(b, length))
                                 - std::max(of(a, place), of(b, place)));
    };
    const double both = common("x", "w") * common("y", "h");
    return both / (of(a, "w") * of(a, "h") + of(b, "w") * of(b, "h") - both);
}

/// Does exactly one found box lie on each true one, and none elsewhere?
bool right(const Json& found, const Json& truth)
{
    if (found.size() != truth.size())
        return false;
    for (const auto& box : truth)
        if (std::ranges::count_if(found, [&](const Json& other) { return overlap(box, other) > 0.5; }) != 1)
            return false;
    return true;
}

}  // namespace

TEST_CASE("face swarm: every image of a scene on demand has its faces where they were drawn")
{
    constexpr int frames = sanitized() ? 6 : 30;
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=scene", "faces=1", "pace=demand"});
    const auto face = swarm.drone("face", "face");
    auto application = swarm.application();
    const auto images = application.collect({{"camera", "image"}}),
               boxes = application.collect({{"face", "faces"}}, {.ordered = true});
    swarm.hivectl_done({"connect", "camera", "face"});
    // What was drawn before all three were connected went to those that were.
    std::map<std::int64_t, Json> truth;
    int seen = 0, correct = 0;
    std::int64_t last = 0;
    while (seen < frames) {
        while (const auto image = images->next(1ms))
            truth[image->identity.sequence] = image->header.at("truth");
        const auto result = boxes->next(patient(200ms));
        if (!result)
            continue;
        CHECK((last == 0 || result->identity.sequence == last + 1));
        last = result->identity.sequence;
        REQUIRE(eventually([&] {
            if (const auto image = images->next(1ms))
                truth[image->identity.sequence] = image->header.at("truth");
            return truth.contains(last);
        }));
        correct += right(result->header.at("faces"), truth.at(last)) ? 1 : 0;
        ++seen;
        CHECK(result->header.at("width") == 640);
    }
    MESSAGE(correct, " of ", seen, " frames exactly right");
    // The detector errs in 4 of 1000 frames of this scene, in the 21st first of all; which ones come is a matter of
    // when all had connected.
    CHECK(correct >= seen - std::max(1, seen / 15));
}

TEST_CASE("face swarm: live from the shell, with results as JSON Lines and an image with the boxes")
{
    const Swarm swarm;
    swarm.hivectl_done({"start", "camera"});
    swarm.hivectl_done({"start", "face"});
    CHECK(swarm.hivectl_done({"connect", "camera", "face"}) == "camera.image -> face.image\n");
    const auto lines = swarm.hivectl_done({"results", "face", "-n", "5"});
    CHECK(std::ranges::count(lines, '\n') == 5);
    CHECK(Json::parse(lines.substr(0, lines.find('\n'))).at("source") == "camera");
    int right = 0;  // the detector errs now and then: see above
    std::istringstream all(lines);
    for (std::string line; std::getline(all, line);)
        right += Json::parse(line).at("header").at("faces").size() == 1 ? 1 : 0;
    CHECK(right >= 4);
    const auto file = swarm.home() / "face.jpg";
    swarm.hivectl_done({"snap", "face.annotated", file.string()});
    const auto image = text_of(file);
    CHECK(image.size() > 5000);
    CHECK(image.starts_with("\xff\xd8"));
    CHECK(image.ends_with("\xff\xd9"));
    // The image is encoded only for a receiver: without requests nothing is annotated.
    auto application = swarm.application();
    const auto annotated = [&] { return application.status("face").outputs.at(1); };
    REQUIRE(annotated().name == "annotated");
    CHECK(eventually([&] { return connected_edges(annotated()) == 0; }));
    const auto top = swarm.hivectl_done({"top", "--once"});
    CHECK(top.find("camera.image") != std::string::npos);
    swarm.hivectl_done({"stop", "--all"});
    CHECK(swarm.hivectl_done({"ps", "--json"}) == "[]\n");
}

TEST_CASE("face swarm: a file is read to its end on demand, shared by two workers, and every image has one result")
{
    const Swarm swarm;
    auto application = swarm.application();
    // Images to read: what the camera itself draws.
    const auto frames = swarm.home() / "frames";
    std::filesystem::create_directory(frames);
    const auto scene = swarm.drone("camera", "scene", {"fps=100"});
    for (int i = 0; i < 8; ++i)
        swarm.hivectl_done({"snap", "scene", (frames / (std::to_string(i) + ".jpg")).string()});
    const auto camera = swarm.drone("camera", "camera", {"source=" + frames.string(), "pace=demand", "loop=off"});
    const auto one = swarm.drone("face", "face-1"), two = swarm.drone("face", "face-2");
    const auto collector = application.collect({{"face-1", "faces"}, {"face-2", "faces"}}, {.ordered = true});
    swarm.hivectl_done({"connect", "camera", "face-*", "--share"});
    int right = 0;
    for (std::int64_t expected = 1; expected <= 8; ++expected) {
        const auto result = collector->next(patient(5000ms));
        REQUIRE(result);
        CHECK(result->identity.sequence == expected);
        right += result->header.at("faces").size() == 1 ? 1 : 0;
    }
    CHECK(right >= 7);
    CHECK_FALSE(collector->next(200ms));
    CHECK(eventually([&] { return application.status("camera").condition == "end of source"; }));
    application.set(
        "camera", {{"hand", true}, {"walkers", 2}});  // of the scene: a set for other swarms does not restart the file
    CHECK(application.status("camera").condition == "end of source");
}

TEST_CASE("face swarm: when another model is refused, the old one keeps finding faces")
{
    const Swarm swarm;
    const onnx::File good(".onnx", onnx::bytes_of(onnx::yunet_model())), garbage(".onnx", "this is no model");
    const media::Folder folder;
    media::write(folder.path() / "1.png", media::encoded(".png", media::sample({32, 32}, CV_8UC3)));
    const auto camera = swarm.drone("camera", "camera", {"source=" + folder.path().string()});
    const auto face = swarm.drone("face", "face", {"yunet=" + good.path()});
    auto application = swarm.application();
    const auto boxes = application.collect({{"face", "faces"}});
    application.connect({"camera", "image"}, {"face", "image"});
    const auto sees_what_the_model_says = [&] {
        const auto result = boxes->next(patient(5000ms));
        return result && result->header.at("faces").size() == 1 && result->header["faces"][0].contains("score");
    };
    CHECK(sees_what_the_model_says());
    CHECK(swarm.hivectl({"set", "face", "yunet=" + garbage.path()}).exit_code == 5);
    for (int i = 0; i < 3; ++i)  // the first of them may be from before
        CHECK(sees_what_the_model_says());
}
