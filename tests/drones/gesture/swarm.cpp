// The gesture swarm from camera to collector: the results equal those of a plain program with the same classes.
#include "page.hpp"
#include "plain_program.hpp"

#include <gesture_finder.hpp>
#include <silhouette.hpp>

#include <cmath>

using namespace hive::test;
using hive::Json;

namespace {

/// A hand as JSON, as on the drone's page.
Json expected(const gesture::Hand& hand)
{
    const auto tenths = [](double value) { return std::round(value * 10) / 10; };
    Json tips = Json::array();
    for (const auto& tip : hand.tips)
        tips.push_back({{"x", tip.x}, {"y", tip.y}});
    Json json{{"x", hand.box.x},
              {"y", hand.box.y},
              {"w", hand.box.width},
              {"h", hand.box.height},
              {"pose", gesture::pose(hand)},
              {"fingers", hand.tips.size()},
              {"palm", {{"x", hand.palm.x}, {"y", hand.palm.y}, {"radius", tenths(hand.radius)}}}};
    json["tips"] = tips;
    if (hand.angle)
        json["angle"] = tenths(*hand.angle);
    return json;
}

/// The hands in a silhouette, or in the parts of an image that have the colour of skin.
Json plain_hands(const cv::Mat& image, const char* from)
{
    gesture::Silhouette silhouette;
    silhouette.from = from;
    Json hands = Json::array();
    for (const auto& hand : gesture::GestureFinder().find(silhouette.of(image)))
        hands.push_back(expected(hand));
    return hands;
}

camera::SceneSettings hand_before(camera::Background wall)
{
    camera::SceneSettings settings;
    settings.background = wall;
    settings.faces = 0;
    settings.hand = true;
    return settings;
}

}  // namespace

TEST_CASE("gesture swarm: on demand, every image of the scene is read as a plain program reads it, and as it was drawn")
{
    constexpr int frames = sanitized() ? 40 : 210;  // 210: once through all gestures
    cv::setNumThreads(1);
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=scene:plain", "hand=on", "faces=0", "pace=demand"});
    const auto gesture = swarm.drone("gesture", "gesture", {"silhouette=skin"});
    auto application = swarm.application();
    const auto collector = application.collect({{"gesture", "gesture"}});
    application.connect({"camera", ""}, {"gesture", ""});
    const camera::Scene scene(hand_before(camera::Background::plain));
    for (int index = 0; index < frames; ++index) {
        CAPTURE(index);
        const auto result = collector->next(patient(Milliseconds(10'000)));
        REQUIRE(result);
        CHECK(result->identity.sequence == index + 1);
        CHECK(result->header.at("hands") == plain_hands(scene.frame(index).image, "skin"));
        const auto truth = scene.frame(index).hands;
        REQUIRE(result->header.at("hands").size() == truth.size());
        if (!truth.empty())
            CHECK(result->header.at("hands")[0].at("fingers") == truth[0].fingers);
    }
}

TEST_CASE(
    "gesture swarm: behind the background drone, on demand, the hands of every image are those of one plain program")
{
    constexpr int frames = sanitized() ? 45 : 210;  // as above; the first 30 are without the hand
    const Swarm swarm;
    const auto gesture = swarm.drone("gesture", "gesture");
    const auto background = swarm.drone("background", "background");
    const auto camera = swarm.drone("camera", "camera", {"hand=on", "faces=0", "pace=demand"});
    auto application = swarm.application();
    const auto collector = application.collect({{"gesture", "gesture"}});
    application.connect({"background", "mask"}, {"gesture", "mask"});
    application.connect({"camera", ""}, {"background", ""});
    const auto settings = hand_before(camera::Background::brick);
    const auto headers = checked_headers(*collector, "hands", frames, [&](std::int64_t first) {
        return plain_program(scene_frames(settings), {}, first, frames,
                             [](std::int64_t, const background::Foreground& found, const cv::Mat&) {
                                 return plain_hands(found.mask, "mask");
                             });
    });
    int shown = 0, read = 0;
    const camera::Scene scene(settings);
    for (std::size_t index = 0; index < headers.size(); ++index)
        if (const auto truth = scene.frame(static_cast<std::int64_t>(index)).hands; !truth.empty()) {
            ++shown;
            const auto& hands = headers[index].at("hands");
            read += !hands.empty() && hands[0].at("fingers") == truth[0].fingers ? 1 : 0;
        }
    MESSAGE(read, " of ", shown, " hands are read as they were drawn");
    CHECK(shown > 0);
    CHECK(read > 0.95 * shown);
}

TEST_CASE("gesture swarm: live, at the defaults, the header is as the page shows it, and the image has the hand marked")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=scene:plain", "hand=on", "faces=0"});
    const auto gesture = swarm.drone("gesture", "gesture");
    auto application = swarm.application();
    const auto collector = application.collect({{"gesture", "gesture"}});
    const auto annotated = application.collect({{"gesture", "annotated"}});
    application.connect({"camera", ""}, {"gesture", ""});
    const Json example = json_example("gesture");
    std::optional<hive::Event> shown;
    REQUIRE(eventually(
        [&] {  // the first second has no hand, a fist has no tips
            shown = collector->next(Milliseconds(500));
            return shown && !shown->header.at("hands").empty() && !shown->header["hands"][0].at("tips").empty();
        },
        Milliseconds(10'000)));
    CHECK(own_keys(shown->header) == keys(example));
    CHECK(keys(shown->header["hands"][0]) == keys(example["hands"][0]));
    CHECK(keys(shown->header["hands"][0]["palm"]) == keys(example["hands"][0]["palm"]));
    const auto image = annotated->next(patient(Milliseconds(5000)));
    REQUIRE(image);
    CHECK(image->header.contains("hands"));
    CHECK(image->body.size() > 5000);
}
