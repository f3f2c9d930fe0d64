// hivectl save: what a camera gives from a file comes to a file, with its times.
#include "media.hpp"
#include "reading.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>
#include <opencv2/videoio.hpp>

#include <cmath>
#include <csignal>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

std::string clip(const std::filesystem::path& folder, int pictures)
{
    const std::string path = (folder / "clip.avi").string();
    cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 12, {64, 48});
    REQUIRE(writer.isOpened());
    for (int i = 0; i < pictures; ++i)
        writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(i % 250)));
    return path;
}

}  // namespace

TEST_CASE("save: a clip on demand comes out with all its frames at their times, and the command ends by itself")
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

TEST_CASE("save: of a live camera it takes as many as it is told, or until Ctrl-C")
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
            return !answer.error && !answer.status.inputs.empty() && answer.status.inputs[0].processed > 5;
        },
        10'000ms));
    ::kill(running.pid(), SIGINT);
    CHECK(running.wait(patient(10'000ms)) == 0);
    CHECK(times_in(other).size() > 5);
}
