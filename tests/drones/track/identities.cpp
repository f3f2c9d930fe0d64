// Background and tracker together, against the truth: how often does a thing change its number?
#include "media.hpp"
#include "scoring.hpp"
#include "seen_boxes.hpp"

#include <doctest/doctest.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <scene.hpp>

using hive::test::boxes_of;

namespace {

scoring::Identities on_scene(int walkers, std::uint64_t seed, int frames)
{
    camera::SceneSettings settings;
    settings.size = {320, 240};
    settings.faces = 0;
    settings.walkers = walkers;
    settings.seed = seed;
    const camera::Scene scene(settings);
    background::ForegroundFinder finder;
    finder.min_area = 75;
    finder.close = 3;
    track::Tracker tracker;
    tracker.width = settings.size.width;
    tracker.height = settings.size.height;
    scoring::Identities score;
    for (int index = 0; index < frames; ++index) {
        const auto [image, truth, hands] = scene.frame(index);
        const auto tracks = tracker.next(index / 30.0, boxes_of(finder.find(image), image));
        std::vector<scoring::TrueBox> walking;
        for (const auto& [kind, id, box] : truth)
            walking.push_back({id, box});
        score.add(tracks, walking, 0.3);
    }
    return score;
}

void report(const std::string& what, const scoring::Identities& score)
{
    MESSAGE(what, ": ", score.switches, " identity switches, ", score.covered, " of ", score.truths,
            " true boxes followed, ", score.false_tracks, " boxes of tracks that follow nothing");
}

}  // namespace

TEST_CASE(
    "identities: walkers of the scene that cross and hide one another keep their ids, but for one crossing in many")
{
    struct Bound {
        int walkers, switches;
    };
    for (const Bound bound : {Bound{1, 0}, {2, 1}, {4, 6}}) {
        const auto score = on_scene(bound.walkers, 1, 900);
        report(std::to_string(bound.walkers) + " walkers", score);
        CHECK(score.switches <= bound.switches);
        CHECK(score.covered >= 0.95 * score.truths);
    }
}

TEST_CASE("identities: the true boxes of 400 frames of pedestrians give the true identities (needs media)")
{
    const auto list = media::shared("media/pedestrians_0001-0400.gt.csv");
    if (!list)
        return;
    track::Tracker tracker;
    scoring::Identities score;
    for (const auto& [image, boxes] : media::ground_truth(*list)) {
        std::vector<track::Box> seen;
        for (const auto& one : boxes)
            seen.push_back({one.box.x, one.box.y, one.box.width, one.box.height});
        score.add(tracker.next(image / 10.0, seen), boxes, 0.3);
    }
    report("true boxes", score);
    CHECK(score.switches == 0);
    CHECK(score.covered >= 0.98 * score.truths);
}

TEST_CASE("identities: pedestrians in the open, by background subtraction alone (needs media)")
{
    const auto clip = media::shared("media/pedestrians_0001-0400.avi"),
               list = media::shared("media/pedestrians_0001-0400.gt.csv");
    if (!clip || !list)
        return;
    auto truth = media::ground_truth(*list);
    background::ForegroundFinder finder;
    finder.min_area = 75;
    finder.close = 3;
    track::Tracker tracker;
    scoring::Identities score;
    cv::VideoCapture video(clip->string());
    cv::Mat image, half;
    for (int number = 1; video.read(image); ++number) {
        cv::resize(image, half, {}, 0.5, 0.5, cv::INTER_AREA);
        score.add(tracker.next(number / 10.0, boxes_of(finder.find(half), half, 2)), truth[number], 0.3);
    }
    report("background", score);
    CHECK(score.switches <= 30);  // people who stand still melt into the background, groups into one box
    CHECK(score.covered >= 0.5 * score.truths);
}
