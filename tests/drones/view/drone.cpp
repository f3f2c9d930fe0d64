// The view drone and the verb view in a swarm, seen by a browser.
#include "free_port.hpp"
#include "http.hpp"

#include <swarm.hpp>

#include <doctest/doctest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <csignal>
#include <fstream>
#include <set>
#include <thread>

using namespace hive::test;
using http::Client, http::get;

namespace {

const std::vector<std::string> no_display{"DISPLAY="};

Process viewer(const Swarm& swarm, int port, std::vector<std::string> settings = {})
{
    settings.push_back("http=" + std::to_string(port));
    settings.push_back("token=" + http::token);
    return swarm.drone("view", "view", settings, {}, no_display);
}

hive::Json status_at(int port, const std::string& token = http::token)
{
    return get(port, "/status.json", token).json();
}
bool shows(int port, const std::string& token = http::token)
{
    return eventually([&] { return status_at(port, token).at("number") > 0; }, Milliseconds(10'000));
}

/// A JPEG file that no encoder of ours makes again.
std::string jpeg_file(const std::filesystem::path& path)
{
    cv::Mat image(48, 64, CV_8UC3);
    cv::randu(image, 0, 255);
    cv::imwrite(path, image, {cv::IMWRITE_JPEG_QUALITY, 37, cv::IMWRITE_JPEG_OPTIMIZE, 1});
    return text_of(path);
}

}  // namespace

TEST_CASE("view: a browser gets the images of a camera, with their sender")
{
    const Swarm swarm;
    const int port = free_port();
    const auto camera = swarm.drone("camera", "camera");
    const auto view = viewer(swarm, port);
    auto application = swarm.application();
    application.connect({"camera", ""}, {"view", ""});
    Client client(port);
    client.ask("/stream.mjpg");
    int images = 0;
    for (int width = 0, height = 0; images < 5; images += height == 480) {
        const auto jpeg = client.next_image();
        REQUIRE(jpeg);
        width = http::decoded(*jpeg).cols;
        height = http::decoded(*jpeg).rows;
        CHECK(width == 640);
    }
    const auto status = status_at(port);
    CHECK(status.at("sender") == "camera.image");
    CHECK(status.at("source") == "camera");
    CHECK(status.at("width") == 640);
    CHECK(status.at("browsers") == 1);
    CHECK(status.at("rate") > 0);
    CHECK(application.status("view").condition == "");
}

TEST_CASE("view: a JPEG goes to the browser byte for byte, unless it is to be written on")
{
    const Swarm swarm;
    const int port = free_port();
    const auto file = jpeg_file(swarm.home() / "one.jpg");
    const auto camera = swarm.drone("camera", "camera", {"source=" + (swarm.home() / "one.jpg").string()});
    const auto view = viewer(swarm, port, {"overlay=off"});
    auto application = swarm.application();
    application.connect({"camera", ""}, {"view", ""});
    REQUIRE(shows(port));
    CHECK(get(port, "/picture.jpg").body == file);
    application.set("view", {{"overlay", true}});
    CHECK(eventually([&] { return get(port, "/picture.jpg").body != file; }, Milliseconds(5000)));
    CHECK(get(port, "/picture.jpg").image().cols == 64);
}

TEST_CASE("view: an image found damaged on viewing is an exception and a notice; the next is shown")
{
    const Swarm swarm;
    const int port = free_port();
    const auto view = viewer(swarm, port);
    auto application = swarm.application();
    const auto exceptions = application.exceptions({"view"});
    const auto good = jpeg_file(swarm.home() / "one.jpg");
    const auto put = [&](const std::string& jpeg) {
        const auto bytes = std::make_shared<const std::string>(jpeg);
        application.put({"view", "image"}, hive::Json::object(), {std::as_bytes(std::span(*bytes)), bytes},
                        "image/jpeg");
    };
    put(good.substr(0, good.size() * 3 / 4) + "\xFF\xD9");  // its headers are sound, its pixels end early
    REQUIRE(eventually([&] { return status_at(port).at("number") == 1; }));
    CHECK(eventually([&] { return get(port, "/picture.jpg").image().cols == 640; }));  // the notice
    const auto exception = exceptions->next(patient(Milliseconds(5000)));
    REQUIRE(exception);
    CHECK(exception->header.at("code") == "malformed");
    put(good);
    CHECK(eventually([&] { return get(port, "/picture.jpg").image().cols == 64; }, Milliseconds(5000)));
}

TEST_CASE("view: the text on a still image is updated, in the snapshot and the stream")
{
    const Swarm swarm;
    const int port = free_port();
    const auto camera = swarm.drone("camera", "camera", {"width=320", "height=240"});
    const auto view = viewer(swarm, port);
    auto application = swarm.application();
    application.connect({"camera", ""}, {"view", ""});
    Client client(port);
    client.ask("/stream.mjpg");
    REQUIRE(client.next_image());
    REQUIRE(shows(port));
    swarm.hivectl_done({"halt", "camera"});
    REQUIRE(eventually([&] { return status_at(port).at("rate") == 0; }, Milliseconds(10'000)));
    const auto number = status_at(port).at("number");
    std::set<std::string> snapshots, streamed;
    REQUIRE(eventually([&] { return snapshots.insert(get(port, "/picture.jpg").body), snapshots.size() >= 3; },
                       Milliseconds(8000)));
    CHECK(snapshots.size() <= 4);
    // By turns: an image of the stream that no reader requests may be skipped, as in any stream.
    for (const auto end = Clock::now() + Milliseconds(60'000); streamed.size() < 3 && Clock::now() < end;) {
        const auto image = client.next_image();
        REQUIRE(image);
        snapshots.insert(get(port, "/picture.jpg").body);
        if (snapshots.contains(*image))
            streamed.insert(*image);
    }
    CHECK(streamed.size() == 3);
    CHECK(status_at(port).at("number") == number);
    swarm.hivectl_done({"resume", "camera"});
    CHECK(eventually([&] { return status_at(port).at("rate") > 0; }, Milliseconds(10'000)));
}

TEST_CASE("view: hold delays the next image of a source on demand; a set releases it")
{
    const Swarm swarm;
    const int port = free_port();
    const auto camera = swarm.drone("camera", "camera", {"pace=demand", "width=64", "height=64"});
    const auto view = viewer(swarm, port, {"hold=60000"});
    auto application = swarm.application();
    application.connect({"camera", ""}, {"view", ""});
    REQUIRE(shows(port));
    for (int i = 0; i < 20; ++i)
        REQUIRE(status_at(port).at("number") == 1);
    CHECK(application.set("view", {{"hold", 0}}).at("hold") == 0);
    CHECK(eventually([&] { return status_at(port).at("number") > 20; }, Milliseconds(10'000)));
}

TEST_CASE("view: a port that is taken refuses the set with the reason, and the old page stays")
{
    const Swarm swarm;
    const int port = free_port();
    const auto view = viewer(swarm, port);
    auto application = swarm.application();
    const auto other = swarm.drone("view", "other", {}, {}, no_display);
    CHECK(application.status("other").condition.find("http=PORT") != std::string::npos);
    const hive::Json both{{"http", port}, {"quality", 50}};
    CHECK_THROWS_WITH_AS(application.set("other", both), doctest::Contains("in use"), hive::Error);
    CHECK_THROWS_WITH_AS(application.set("view", {{"bind", "example.com"}}), doctest::Contains("not an address"),
                         hive::Error);
    CHECK_THROWS_WITH_AS(application.set("view", {{"window", "on"}}), doctest::Contains("--http"), hive::Error);
    CHECK(get(port, "/").code == 200);
    CHECK(application.get("other", {"quality"}).at("quality") == 80);
}

TEST_CASE("hivectl view: prints the address, shows the one output, and leaves nothing when it is interrupted")
{
    const Swarm swarm;
    const int port = free_port();
    const auto camera = swarm.drone("camera", "camera");
    auto process =
        swarm.hivectl_running({"view", "camera", "--http", std::to_string(port), "--encoding", "jpeg:60"}, "seen");
    const std::string address = "http://127.0.0.1:" + std::to_string(port) + "/?token=";
    std::string log;
    REQUIRE(
        eventually([&] { return (log = swarm.log("seen")).find(address) != std::string::npos && log.ends_with("\n"); },
                   Milliseconds(15'000)));
    const auto token = log.substr(log.find(address) + address.size(), 32);
    CHECK(token.find_first_not_of("0123456789abcdef") == std::string::npos);
    CHECK(get(port, "/picture.jpg").code == 403);
    REQUIRE(shows(port, token));
    CHECK(get(port, "/picture.jpg", token).image().rows == 480);
    const auto edges = hive::Json::parse(swarm.hivectl_done({"connections", "--json"}));
    REQUIRE(edges.size() == 1);
    CHECK(edges[0].at("from") == "camera.image");
    CHECK(edges[0].at("encoding") == "jpeg:60");
    process.signal(SIGINT);
    CHECK(process.wait(Milliseconds(60'000)) == 130);
    CHECK(swarm.application().drones() == std::vector<std::string>{"camera"});
    for (const char* ending : {".sock", ".state", ".log"})
        CHECK_FALSE_MESSAGE(std::filesystem::exists(swarm.home() / ("viewer" + std::string(ending))), ending);
}

TEST_CASE("hivectl view: SIGTERM is exit code 143, and a signal that comes twice at once, as of timeout, leaves "
          "nothing running either")
{
    const Swarm swarm;
    const int port = free_port();
    const auto camera = swarm.drone("camera", "camera");
    const auto drones = [&] { return swarm.application().drones(); };
    for (int round = 0; round < 6; ++round) {
        const auto name = "seen-" + std::to_string(round);
        auto process = swarm.hivectl_running({"view", "camera", "--http", std::to_string(port)}, name);
        if (round % 2 == 0)
            REQUIRE(
                eventually([&] { return swarm.log(name).find("http://") != std::string::npos; }, Milliseconds(15'000)));
        else
            REQUIRE(
                eventually([&] { return std::filesystem::exists(swarm.home() / "viewer.log"); }, Milliseconds(15'000)));
        process.signal(SIGTERM);
        const auto first = Clock::now();
        std::this_thread::sleep_for(Milliseconds(round * 5));
        process.signal(SIGTERM);
        const bool at_once = Clock::now() - first < Milliseconds(100);
        CHECK(process.wait(Milliseconds(60'000)) == 128 + SIGTERM);
        if (!at_once) {  // the second was one of its own, and ended it without more ado
            swarm.hivectl({"stop", "viewer"});
            continue;
        }
        CHECK(drones() == std::vector<std::string>{"camera"});
        for (const char* ending : {".sock", ".state", ".log"})
            CHECK_FALSE_MESSAGE(std::filesystem::exists(swarm.home() / ("viewer" + std::string(ending))), ending);
    }
}

TEST_CASE("hivectl view: the drone stops with the command, even if that is killed, and saves no state")
{
    const Swarm swarm;
    const int port = free_port();
    const auto camera = swarm.drone("camera", "camera");
    auto process = swarm.hivectl_running({"view", "camera", "--http", std::to_string(port)}, "seen");
    REQUIRE(eventually([&] { return swarm.log("seen").find("http://") != std::string::npos; }, Milliseconds(15'000)));
    process.kill();
    CHECK(eventually([&] { return swarm.application().drones() == std::vector<std::string>{"camera"}; },
                     Milliseconds(5000)));
    CHECK_FALSE(std::filesystem::exists(swarm.home() / "viewer.state"));
}

TEST_CASE("hivectl view: several started at once each have their own drone")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera");
    std::vector<Process> views;
    for (const char* name : {"a", "b", "c"})
        views.push_back(swarm.hivectl_running({"view", "camera", "--http", std::to_string(free_port())}, name));
    for (const char* name : {"a", "b", "c"})
        REQUIRE_MESSAGE(
            eventually([&] { return swarm.log(name).find("http://") != std::string::npos; }, Milliseconds(15'000)),
            swarm.log(name));
    CHECK(swarm.application().drones() == std::vector<std::string>{"camera", "viewer", "viewer-2", "viewer-3"});
    for (auto& view : views) {
        view.signal(SIGINT);
        CHECK(view.wait(Milliseconds(60'000)) == 130);
    }
    CHECK(swarm.application().drones() == std::vector<std::string>{"camera"});
}

TEST_CASE("hivectl view: without a display it names --http; a drone without images is refused; no process is left "
          "running")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera");
    const auto ticker = swarm.drone("ticker", "ticker");
    const auto refused =
        swarm.run({"/usr/bin/env", "-u", "DISPLAY", swarm.program("hivectl").string(), "view", "camera"});
    CHECK(refused.exit_code == 5);
    CHECK(refused.err.find("--http PORT") != std::string::npos);
    CHECK(swarm.hivectl({"view", "nobody", "--http", "8080"}).exit_code == 3);
    CHECK(swarm.hivectl({"view", "ticker", "--http", std::to_string(free_port())}).exit_code == 6);
    CHECK(swarm.application().drones() == std::vector<std::string>{"camera", "ticker"});
}
