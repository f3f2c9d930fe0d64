// The gesture swarm from camera to collector: what is read equals what a plain program with the same classes reads.
#include "page.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <gesture_finder.hpp>
#include <scene.hpp>
#include <silhouette.hpp>

#include <opencv2/core/utility.hpp>

#include <cmath>

using namespace hive::test;
using hive::Json;

namespace {

/// What a hand is on the wire, as the drone's page says.
Json expected(const gesture::Hand& hand)
{
    const auto tenths = [](double value) { return std::round(value * 10) / 10; };
    Json tips = Json::array();
    for (const auto& tip : hand.tips)
        tips.push_back({{"x", tip.x}, {"y", tip.y}});
    Json json{{"x", hand.box.x}, {"y", hand.box.y}, {"w", hand.box.width}, {"h", hand.box.height}, {"pose", gesture::pose(hand)},
              {"fingers", hand.tips.size()}, {"palm", {{"x", hand.palm.x}, {"y", hand.palm.y}, {"radius", tenths(hand.radius)}}}};
    json["tips"] = tips;
    if (hand.angle)
        json["angle"] = tenths(*hand.angle);
    return json;
}

/// What a program without Hive makes of picture `index` of the same scene.
Json plain(const camera::Scene& scene, int index)
{
    gesture::Silhouette skin;
    skin.from = "skin";
    Json hands = Json::array();
    for (const auto& hand : gesture::GestureFinder().find(skin.of(scene.picture(index).image)))
        hands.push_back(expected(hand));
    return hands;
}

}  // namespace

TEST_CASE("gesture swarm: on demand, every picture of the scene is read as a plain program reads it, and as it was drawn")
{
    constexpr int pictures = sanitized() ? 40 : 210;  // 210: once through all gestures
    cv::setNumThreads(1);
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=scene:plain", "hand=on", "faces=0", "pace=demand"});
    const auto gesture = swarm.drone("gesture", "gesture", {"silhouette=skin"});
    auto application = swarm.application();
    const auto collector = application.collect({{"gesture", "gesture"}});
    application.connect({"camera", ""}, {"gesture", ""});
    camera::SceneSettings settings;
    settings.background = camera::Background::plain;
    settings.faces = 0;
    settings.hand = true;
    const camera::Scene scene(settings);
    for (int index = 0; index < pictures; ++index) {
        CAPTURE(index);
        const auto result = collector->next(patient(Milliseconds(10'000)));
        REQUIRE(result);
        CHECK(result->identity.sequence == index + 1);
        CHECK(result->header.at("hands") == plain(scene, index));
        const auto truth = scene.picture(index).hands;
        REQUIRE(result->header.at("hands").size() == truth.size());
        if (!truth.empty())
            CHECK(result->header.at("hands")[0].at("fingers") == truth[0].fingers);
    }
}

TEST_CASE("gesture swarm: live, the header is as the page shows it, and the picture has the hand marked")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=scene:plain", "hand=on", "faces=0"});
    const auto gesture = swarm.drone("gesture", "gesture", {"silhouette=skin"});
    auto application = swarm.application();
    const auto collector = application.collect({{"gesture", "gesture"}});
    const auto annotated = application.collect({{"gesture", "annotated"}});
    application.connect({"camera", ""}, {"gesture", ""});
    const Json example = json_example("gesture");
    std::optional<hive::Event> shown;
    REQUIRE(eventually([&] {  // the first second has no hand, a fist has no tips
        shown = collector->next(Milliseconds(500));
        return shown && !shown->header.at("hands").empty() && !shown->header["hands"][0].at("tips").empty();
    }, Milliseconds(10'000)));
    CHECK(keys(shown->header) == keys(example));
    CHECK(keys(shown->header["hands"][0]) == keys(example["hands"][0]));
    CHECK(keys(shown->header["hands"][0]["palm"]) == keys(example["hands"][0]["palm"]));
    const auto picture = annotated->next(patient(Milliseconds(5000)));
    REQUIRE(picture);
    CHECK(picture->header.contains("hands"));
    CHECK(picture->body.size() > 5000);
}
