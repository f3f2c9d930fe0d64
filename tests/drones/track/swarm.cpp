// The tracking swarm, camera to tracks: the same tracks as one program that calls the same algorithms in a loop.
#include "plain_program.hpp"
#include "seen_boxes.hpp"

#include "../../../drones/track/boxes.hpp"

#include <possible.hpp>

#include <opencv2/videoio.hpp>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

constexpr int frames = sanitized() ? 60 : 240, fps = 30;

camera::SceneSettings settings()
{
    camera::SceneSettings result;
    result.size = {320, 240};
    result.faces = 0;
    result.walkers = 3;
    return result;
}

/// Tracks of each frame as the swarm writes them.
template <class Frame>
std::map<std::int64_t, Json> plain_tracks(Frame frame, cv::Size size, std::int64_t first)
{
    background::ForegroundFinder finder;
    finder.min_area = 75;
    track::Tracker tracker;
    tracker.width = size.width;
    tracker.height = size.height;
    return plain_program(std::move(frame), finder, first, frames,
                         [&](std::int64_t sequence, const background::Foreground& found, const cv::Mat& image) {
                             return track::to_json(
                                 tracker.next(static_cast<double>(sequence) / fps, boxes_of(found, image)));
                         });
}

std::size_t confirmed(const Json& tracks)
{
    return static_cast<std::size_t>(
        std::ranges::count_if(tracks, [](const Json& one) { return one.at("confirmed") == true; }));
}

}  // namespace

TEST_CASE("tracking swarm: the tracks of every frame on demand are those of one plain program")
{
    const Swarm swarm;
    const auto track = swarm.drone("track", "track", {"fps=" + std::to_string(fps)});
    const auto background = swarm.drone("background", "background", {"min_area=75"});
    const auto camera =
        swarm.drone("camera", "camera", {"width=320", "height=240", "faces=0", "walkers=3", "pace=demand"});
    auto application = swarm.application();
    const auto collector = application.collect({{"track", "tracks"}});
    swarm.hivectl_done({"connect", "background", "track"});
    swarm.hivectl_done({"connect", "camera", "background"});
    std::size_t most = 0;
    for (const auto& header : checked_headers(*collector, "tracks", frames, [](auto first) {
             return plain_tracks(scene_frames(settings()), settings().size, first);
         })) {
        CHECK(header.at("width") == 320);
        most = std::max(most, confirmed(header.at("tracks")));
    }
    CHECK(most >= (sanitized() ? 1 : 3));
}

TEST_CASE("tracking swarm: so are those of filmed walkers")
{
    const auto video = shared_data("media/pedestrians_0001-0400.avi");
    if (!possible(video ? "" : "the videos in the folder that HIVE_SHARED names"))
        return;
    const Swarm swarm;
    const auto track = swarm.drone("track", "track", {"fps=" + std::to_string(fps)});
    const auto background = swarm.drone("background", "background", {"min_area=75"});
    const auto camera = swarm.drone("camera", "camera", {"source=" + video->string(), "pace=demand"});
    auto application = swarm.application();
    const auto collector = application.collect({{"track", "tracks"}});
    swarm.hivectl_done({"connect", "background", "track"});
    swarm.hivectl_done({"connect", "camera", "background"});
    cv::VideoCapture film(video->string(), cv::CAP_FFMPEG);
    const cv::Size size(static_cast<int>(film.get(cv::CAP_PROP_FRAME_WIDTH)),
                        static_cast<int>(film.get(cv::CAP_PROP_FRAME_HEIGHT)));
    std::int64_t read = 0;
    const auto frame = [&](std::int64_t sequence) {
        cv::Mat result;
        for (; read < sequence; ++read)
            REQUIRE(film.read(result));
        return result;
    };
    std::size_t most = 0;
    for (const auto& header :
         checked_headers(*collector, "tracks", frames, [&](auto first) { return plain_tracks(frame, size, first); }))
        most = std::max(most, confirmed(header.at("tracks")));
    CHECK(most >= (sanitized() ? 1 : 3));
}

TEST_CASE("tracking swarm: the script starts it, live, and tracks come to the shell")
{
    const Swarm swarm;
    const auto script = std::filesystem::path(HIVE_SOURCE_DIR) / "scripts/swarms/tracking.sh";
    const auto started = swarm.run({script.string(), "faces=0", "walkers=3", "width=320", "height=240", "fps=60"});
    CAPTURE(started.out);
    CAPTURE(started.err);
    REQUIRE(started.exit_code == 0);
    auto application = swarm.application();
    const auto collector = application.collect({{"track", "tracks"}}),
               masks = application.collect({{"background", "mask"}}),
               foregrounds = application.collect({{"background", "foreground"}});
    const auto followed = [&] {
        const auto event = collector->next(patient(1000ms));
        return event && confirmed(event->header.at("tracks")) > 0;
    };
    CHECK(eventually(followed, patient(20'000ms)));
    const auto mask = masks->next(patient(5000ms));
    REQUIRE(mask);
    CHECK(mask->type == "image/raw");
    CHECK(mask->header.at("pixel_format") == "gray8");
    CHECK(mask->body.size() == 320 * 240);
    const auto foreground = foregrounds->next(patient(5000ms));
    REQUIRE(foreground);
    CHECK(foreground->header.at("pixel_format") == "bgr8");
    CHECK(foreground->body.size() == 3 * 320 * 240);
    CHECK(std::count(foreground->body.data(), foreground->body.data() + foreground->body.size(), 0)
          > 3 * 320 * 240 / 2);  // most of the wall is black
    swarm.hivectl_done({"stop", "--all"});
}
