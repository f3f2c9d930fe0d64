// The end of a folder of images, behind two face drones that share the work, as each verb of hivectl sees it.
#include "free_port.hpp"
#include "media.hpp"
#include "status_sums.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <csignal>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

constexpr int images = 30;

std::string folder_of_images(const std::filesystem::path& folder)
{
    for (int i = 0; i < images; ++i)
        media::write(folder / (std::to_string(100 + i) + ".jpg"),
                     media::encoded(".jpg", media::sample({64, 48}, CV_8UC3, i)));
    return folder.string();
}

std::ptrdiff_t lines(const std::string& text) { return std::ranges::count(text, '\n'); }

/// A camera that is halted, and two workers that share its images.
struct Sharing {
    Swarm swarm;
    media::Folder folder;
    Process camera = swarm.drone(
        "camera", "camera", {"source=" + folder_of_images(folder.path()), "pace=demand", "loop=off"}, {"--halted"});
    Process first = swarm.drone("face", "face-1"), second = swarm.drone("face", "face-2");
    hive::Application application = swarm.application();

    Sharing() { swarm.hivectl_done({"connect", "camera", "face-1", "face-2", "--share"}); }

    /// Number of receivers of a worker's results.
    [[nodiscard]] std::size_t receivers(const std::string& worker)
    {
        std::size_t count = 0;
        for (const auto& output : application.status(worker).outputs)
            count += output.name == "exceptions" ? 0 : connected_edges(output);
        return count;
    }
    [[nodiscard]] bool ended(const std::string& drone)
    {
        const auto status = application.status(drone);
        return std::ranges::any_of(status.inputs,
                                   [](const auto& input) { return input.why == hive::Reason::source_ended; });
    }
};

}  // namespace

TEST_CASE("end: behind workers that share, results, collect, record, save, view and snap end by themselves with 0")
{
    Sharing sharing;
    const auto& swarm = sharing.swarm;
    const auto file = [&](const char* name) { return (swarm.home() / name).string(); };
    const std::vector<std::pair<std::string, std::vector<std::string>>> verbs{
        {"results", {"results", "face-1", "face-2", "--ordered"}},
        {"collect", {"collect", "face-1.faces", "face-1.annotated"}},
        {"record", {"record", "face-1.faces", "face-2.faces", "-o", file("run.hive")}},
        {"save", {"save", "face-1.annotated", file("out.mp4"), "--timeout", "60"}},
        {"view", {"view", "face-1.annotated", "--http", std::to_string(free_port()), "--timeout", "60"}},
        {"snap", {"snap", "face-1.annotated", file("one.jpg"), "--timeout", "60"}}};
    std::vector<Process> running;
    for (const auto& [name, words] : verbs)
        running.push_back(swarm.hivectl_running(words, name));
    const bool connected =
        eventually([&] { return sharing.receivers("face-1") == 7 && sharing.receivers("face-2") == 2; }, 20'000ms);
    REQUIRE_MESSAGE(connected, sharing.receivers("face-1"), " and ", sharing.receivers("face-2"), " receivers\n",
                    swarm.hivectl({"connections"}).out);
    sharing.application.resume("camera");
    for (std::size_t i = 0; i < verbs.size(); ++i)
        CHECK_MESSAGE(running[i].wait(patient(30'000ms)) == 0, verbs[i].first, ": ", swarm.log(verbs[i].first));
    CHECK(lines(swarm.log("results")) == images);
    CHECK(swarm.log("record").find(std::to_string(images) + " events") != std::string::npos);
    CHECK(lines(swarm.log("collect")) > 0);
    CHECK(std::filesystem::file_size(file("one.jpg")) > 0);
}

TEST_CASE("end: with --stay, results, collect, record and view go on behind workers that share")
{
    Sharing sharing;
    const auto& swarm = sharing.swarm;
    sharing.application.resume("camera");
    swarm.hivectl_done({"results", "face-1", "face-2"});
    for (const auto& words : {std::vector<std::string>{"results", "face-1", "face-2"},
                              {"collect", "face-1.faces", "face-2.faces"},
                              {"record", "face-1.faces", "-o", (swarm.home() / "run.hive").string()}}) {
        auto staying = words;
        staying.insert(staying.end(), {"--stay", "--timeout", "0.5"});
        CHECK_MESSAGE(swarm.hivectl(staying).exit_code == 124, words[0]);
    }
    auto view =
        swarm.hivectl_running({"view", "face-1.annotated", "--http", std::to_string(free_port()), "--stay"}, "view");
    REQUIRE(eventually([&] { return swarm.hivectl({"ps"}).out.find("viewer") != std::string::npos; }, 10'000ms));
    REQUIRE(eventually([&] { return sharing.ended("viewer"); }, 10'000ms));
    CHECK_FALSE(view.wait(1500ms));  // it checks twice per second whether everything has been shown
    view.signal(SIGINT);
    CHECK(view.wait(patient(10'000ms)).has_value());
}
