// hivectl save: images that a camera reads from a file are saved with their times.
#include "media.hpp"
#include "reading.hpp"
#include "sink.hpp"
#include "source.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>
#include <opencv2/videoio.hpp>

#include <cmath>
#include <csignal>
#include <sstream>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

std::string clip(const std::filesystem::path& folder, int images)
{
    const std::string path = (folder / "clip.avi").string();
    cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 12, {64, 48});
    REQUIRE(writer.isOpened());
    for (int i = 0; i < images; ++i)
        writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(i % 250)));
    return path;
}

/// Uneven, as those of a camera.
std::chrono::microseconds time_of(int index) { return std::chrono::microseconds(33'367 * index + (index % 3) * 4'000); }

/// A drawn face before a wall, for 300 images.
std::string clip_with_face(const std::filesystem::path& folder)
{
    const std::string path = (folder / "face.mp4").string();
    camera::SourceSettings settings;
    settings.text = "scene:plain";
    settings.size = {320, 240};
    const auto scene = camera::open_source(settings);
    const auto sink = writing::open_sink({.path = path});
    for (int i = 0; i < 300; ++i)
        sink->add({.pixels = scene->next()->image, .sequence = i + 1, .fps = 30}, time_of(i));
    sink->close();
    return path;
}

/// The seconds at which images are shown, by ffprobe.
std::vector<double> probed(const Swarm& swarm, const std::string& path)
{
    const auto finished = swarm.run({"/usr/bin/ffprobe", "-v", "error", "-select_streams", "v", "-show_entries",
                                     "frame=pts_time", "-of", "csv=p=0", path},
                                    30'000ms);
    CHECK_MESSAGE(finished.exit_code == 0, finished.err);
    CHECK_MESSAGE(finished.err.empty(), finished.err);
    std::vector<double> times;
    std::istringstream lines(finished.out);
    for (std::string line; std::getline(lines, line);)
        if (!line.empty())
            times.push_back(std::stod(line));
    return times;
}

/// In how many images has something been drawn?
int differing(const std::string& path, const std::string& from)
{
    cv::VideoCapture drawn(path, cv::CAP_FFMPEG), plain(from, cv::CAP_FFMPEG);
    int count = 0;
    for (cv::Mat a, b; drawn.read(a) && plain.read(b);)
        count += cv::norm(a, b, cv::NORM_INF) > 100 ? 1 : 0;
    return count;
}

}  // namespace

TEST_CASE("save: 300 images of a clip, with the faces framed, are 300 frames at the same times, as ffprobe reads them")
{
    if (!possible(std::filesystem::exists("/usr/bin/ffprobe") ? "" : "ffprobe, of Debian's package ffmpeg"))
        return;
    const Swarm swarm;
    const media::Folder folder;
    const auto from = clip_with_face(folder.path()), path = (folder.path() / "out.mp4").string();
    const auto camera = swarm.drone("camera", "camera", {"source=" + from, "pace=demand", "loop=off"});
    const auto face = swarm.drone("face", "face", {"scale=1.3"});
    swarm.hivectl_done({"connect", "camera", "face"});
    swarm.hivectl_done({"save", "face.annotated", path}, 60'000ms);
    const auto times = probed(swarm, path);
    REQUIRE(times.size() == 300);
    for (int i = 0; i < 300; ++i)
        CHECK(std::abs(times[static_cast<std::size_t>(i)] - std::chrono::duration<double>(time_of(i)).count())
              <= 0.001);
    CHECK(differing(path, from) > 200);
}

TEST_CASE("save: a clip on demand is saved with all its frames at their times, and the command exits")
{
    const Swarm swarm;
    const media::Folder folder;
    const auto camera =
        swarm.drone("camera", "camera", {"source=" + clip(folder.path(), 90), "pace=demand", "loop=off"});
    const auto path = (folder.path() / "out.mp4").string();
    const auto said = swarm.hivectl_done({"save", "camera", path});
    CHECK_MESSAGE(said.find("90 frames") != std::string::npos, said);
    const auto times = times_in(path);
    REQUIRE(times.size() == 90);
    for (std::size_t i = 0; i < times.size(); ++i)
        CHECK(std::abs(times[i] - static_cast<double>(i) / 12) <= 0.001);
    CHECK(swarm.hivectl({"save", "camera", path}).exit_code == 5);  // it is there already
    CHECK(swarm.hivectl({"ps"}).out.find("writer") == std::string::npos);
}

TEST_CASE("save: a looped clip continues at the interval of its images")
{
    const Swarm swarm;
    const media::Folder folder;
    const auto camera =
        swarm.drone("camera", "camera", {"source=" + clip(folder.path(), 12), "pace=demand", "loop=on"});
    const auto path = (folder.path() / "out.mp4").string();
    swarm.hivectl_done({"save", "camera", path, "-n", "30"});
    const auto times = times_in(path);
    REQUIRE(times.size() == 30);
    for (std::size_t i = 0; i < times.size(); ++i)
        CHECK(std::abs(times[i] - static_cast<double>(i) / 12) <= 0.001);
}

TEST_CASE("save: on a full disk it reports the number of readable frames, and the reason once")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=scene:noise", "noise=50", "pace=demand"});
    const auto path = (swarm.home() / "full.mkv").string();
    const auto saved = swarm.run(
        {"/bin/bash", "-c", "ulimit -f 2000; exec hivectl save camera '" + path + "' --quality 100"}, 60'000ms);
    CHECK_MESSAGE(saved.exit_code == 8, saved.err);
    CHECK_MESSAGE(saved.err == "hivectl save: " + path + ": File too large\n", saved.err);
    const auto frames = std::to_string(times_in(path).size()) + " frames";
    CHECK_MESSAGE(saved.out.find(path + ": " + frames + " in ") != std::string::npos, saved.out, " but ", frames);
}

TEST_CASE("save: a live camera is saved up to the requested number, or until Ctrl-C")
{
    const Swarm swarm;
    const media::Folder folder;
    const auto camera = swarm.drone("camera", "camera", {"source=scene:plain", "fps=100", "width=64", "height=64"});
    const auto path = (folder.path() / "out.mkv").string(), other = (folder.path() / "other.mp4").string();
    swarm.hivectl_done({"save", "camera", path, "-n", "20"});
    CHECK(times_in(path).size() == 20);
    auto running = swarm.hivectl_running({"save", "camera", other}, "save");
    auto application = swarm.application();
    REQUIRE(eventually(
        [&] {
            const auto answer = application.status(std::vector<std::string>{"writer"}).at(0);
            const auto* status = value_of(answer.status);
            return status && !status->inputs.empty() && status->inputs[0].processed > 5;
        },
        10'000ms));
    ::kill(running.pid(), SIGINT);
    CHECK(running.wait(patient(10'000ms)) == 0);
    CHECK(times_in(other).size() > 5);
}
