// The write drone as a process: its parameters, the headers of its peers, and crashes.
#include "media.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>
#include <raw_peer.hpp>

#include <csignal>

#include <sys/stat.h>

using namespace hive::test;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

/// A writer, and an application that gives it images one by one.
struct Desk {
    Swarm swarm;
    Process writer;
    hive::Application application = swarm.application();

    explicit Desk(const std::vector<std::string>& settings) : writer(swarm.drone("write", "writer", settings)) {}

    void give(const hive::Json& header = hive::Json::object())
    {
        const auto jpeg = media::encoded(".jpg", media::sample({64, 48}, CV_8UC3));
        application.put({"writer", "image"}, header, hive::Body(std::string(jpeg.begin(), jpeg.end())), "image/jpeg");
    }
};

bool comes_to_have(const fs::path& folder, int images)
{
    return eventually([&] { return lines_of(text_of(folder / "times.csv")) == images + 1; });
}

}  // namespace

TEST_CASE("write: a killed and restarted writer continues in a new file, and the old file stays")
{
    const media::Folder folder;
    std::string overwrite, first = "run/", second = "run-2/", table = "times.csv";
    SUBCASE("a folder, overwrite=off") { overwrite = "off"; }
    SUBCASE("a folder, overwrite=on") { overwrite = "on"; }
    SUBCASE("a video, overwrite=on")
    {
        overwrite = "on";
        first = "run.mp4", second = "run-2.mp4", table = "";
    }
    const auto in = [&](const std::string& name) { return folder.path() / (name + table); };
    Desk desk({"file=" + (folder.path() / first).string(), "overwrite=" + overwrite});
    desk.give();
    REQUIRE(eventually([&] { return !text_of(in(first)).empty(); }));
    desk.writer.kill();
    const auto kept = text_of(in(first));
    const auto again = desk.swarm.drone("write", "writer");
    CHECK(desk.application.get("writer", {"file"}).at("file") == (folder.path() / second).string());
    desk.give();
    CHECK(eventually([&] { return !text_of(in(second)).empty(); }));
    CHECK(text_of(in(first)) == kept);
}

TEST_CASE("write: images of a folder keep their own times, and one that goes back follows the last")
{
    const media::Folder folder;
    const auto out = folder.path() / "out";
    Desk desk({"file=" + out.string() + "/"});
    desk.give({{"file", "1.jpg"}, {"media_time_us", 0}});
    desk.give({{"file", "2.jpg"}, {"media_time_us", 500'000}});
    desk.give({{"file", "another.mp4"}, {"media_time_us", 0}});
    desk.give({{"file", "another.mp4"}, {"media_time_us", 300'000}});
    REQUIRE(comes_to_have(out, 4));
    const auto table = text_of(out / "times.csv");
    for (const char* time : {",0\n", ",500000\n", ",1000000\n", ",1300000\n"})
        CHECK_MESSAGE(has(table, time), table);
}

TEST_CASE("write: an impossible frame rate is ignored")
{
    const media::Folder folder;
    const auto out = folder.path() / "out";
    Desk desk({"file=" + out.string() + "/"});
    for (const double fps : {0.0, 1e-9, 1e-300, -5.0, 1e9})
        desk.give({{"fps", fps}, {"media_time_us", 0}});
    REQUIRE(comes_to_have(out, 5));
    CHECK_MESSAGE(has(text_of(out / "times.csv"), ",160000\n"), text_of(out / "times.csv"));
    CHECK_THROWS_AS(desk.application.set("writer", {{"fps", 1e-300}}), hive::Error);
    desk.application.set("writer", {{"fps", 0.01}});
    CHECK(desk.application.get("writer", {"fps"}).at("fps") == 0.01);
}

TEST_CASE("write: a FIFO or a device is refused without blocking or stopping the drone")
{
    const media::Folder folder;
    const auto pipe = folder.path() / "pipe.mp4", link = folder.path() / "link.mp4", out = folder.path() / "out";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    fs::create_symlink("/dev/null", link);
    Desk desk({"overwrite=on"});
    for (const auto& path : {pipe, link})
        try {
            desk.application.set("writer", {{"file", path.string()}});
            FAIL("it was taken");
        } catch (const hive::Error& error) {
            CHECK(has(error.what(), path.string() + " is not a regular file"));
        }

    fs::create_directory(out);
    REQUIRE(::mkfifo((out / "times.csv").c_str(), 0600) == 0);
    desk.application.set("writer", {{"file", out.string() + "/"}});
    desk.give();
    CHECK(eventually([&] { return has(desk.swarm.log("writer"), "times.csv is not a regular file"); }));

    const auto video = folder.path() / "video.mp4";
    std::ofstream(video) << "older";
    fs::create_symlink("video.mp4", folder.path() / "linked.mp4");
    desk.application.set("writer", {{"file", (folder.path() / "linked.mp4").string()}});
    desk.give();
    CHECK(eventually([&] { return fs::file_size(video) > 100; }));
}

TEST_CASE("write: an aborted set of another file leaves the current one unchanged, and a committed one ends it")
{
    const media::Folder folder;
    std::string overwrite;
    SUBCASE("overwrite=off") { overwrite = "off"; }
    SUBCASE("overwrite=on") { overwrite = "on"; }
    const auto a = folder.path() / "a", b = folder.path() / "b";
    Desk desk({"file=" + a.string() + "/", "overwrite=" + overwrite});
    desk.give();
    REQUIRE(comes_to_have(a, 1));
    auto asker = raw::Peer::meet(desk.swarm.home() / "writer.sock");
    const raw::Json wanted{{"parameters", {{"file", b.string() + "/"}}}, {"prepare", 7}, {"deadline_ms", 5000}};
    REQUIRE(raw::text_of(asker.ask(raw::set, wanted)) == "");
    REQUIRE(raw::text_of(asker.ask(raw::set, {{"abort", 7}})) == "");
    const auto files = desk.application.collect({{"writer", "files"}});
    desk.give();
    CHECK(comes_to_have(a, 2));
    CHECK_FALSE(fs::exists(b));
    desk.application.set("writer", {{"file", ""}});
    const auto told = files->next(patient(5000ms));
    REQUIRE(told.has_value());
    CHECK(told->header.at("file") == a.string() + "/");
    CHECK(told->header.at("frames") == 2);
}
