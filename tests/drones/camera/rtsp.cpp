// The camera drone and a real RTSP server (GStreamer's): slow streams, logins, a server that goes and comes back.
#include "rtsp_server.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <filesystem>
#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

namespace fs = std::filesystem;

bool ready(const RtspServer& server)
{
    return possible(server.ready() ? "" : "GStreamer's RTSP server, which did not start: " + server.said());
}

std::string condition_of(hive::Application& application) { return application.status("camera").condition; }
bool says_so(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("rtsp: slow and quick streams open, over TCP and UDP")
{
    const Swarm swarm;
    int number = 0;
    for (const auto& [rate, way] : {std::pair{"1", "tcp"}, {"12", "tcp"}, {"30", "udp"}}) {
        const std::string fps = rate, transport = way;  // clang 14 captures no bindings
        CAPTURE(fps);
        const RtspServer server(swarm, rtsp_port(number++), fps,
                                transport == "udp" ? std::vector<std::string>{"--udp"} : std::vector<std::string>{});
        if (!ready(server))
            return;
        const auto name = "camera-" + fps;
        const auto camera = swarm.drone("camera", name, {"source=" + server.url(), "transport=" + transport});
        auto application = swarm.application();
        const auto images = application.collect({{name, "image"}});
        const auto event = images->next(patient(20'000ms));
        REQUIRE_MESSAGE(event, application.status(name).condition);
        CHECK(event->header.at("width") == 320);
        CHECK(event->header.value("fps", 0.0) == doctest::Approx(std::stod(fps)));
        CHECK(application.status(name).condition.empty());
    }
}

TEST_CASE("rtsp: a login is read from a file, reported as missing or wrong, and never printed")
{
    const Swarm swarm;
    const RtspServer server(swarm, rtsp_port(5), "30", {"--login", "viewer:s3cr:t/%"});
    if (!ready(server))
        return;
    const auto camera = swarm.drone("camera", "camera", {"source=" + server.url()});
    auto application = swarm.application();
    CHECK(eventually([&] { return says_so(condition_of(application), "login required"); }, 20'000ms));
    const auto file = swarm.home() / "login";
    const auto write = [&](const std::string& text) {
        std::ofstream(file) << text << '\n';
        fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
    };
    write("viewer:wrong");
    application.set("camera", {{"credentials", file.string()}});
    CHECK(eventually([&] { return says_so(condition_of(application), "refuses this login"); }, 20'000ms));
    CHECK(eventually([&] { return says_so(condition_of(application), "to retry"); }, 20'000ms));
    write("viewer:s3cr:t/%");
    application.set("camera", {{"credentials", file.string()}});
    CHECK(application.collect({{"camera", "image"}})->next(patient(20'000ms)));
    CHECK_FALSE(says_so(swarm.log("camera"), "s3cr"));
    CHECK_FALSE(says_so(text_of("/proc/" + std::to_string(camera.pid()) + "/cmdline"), "s3cr"));
    CHECK_FALSE(says_so(application.get("camera").dump(), "s3cr"));
}

TEST_CASE("rtsp: a camera that goes away and comes back gives images again")
{
    const Swarm swarm;
    RtspServer server(swarm, rtsp_port(8), "30");
    if (!ready(server))
        return;
    const auto camera = swarm.drone("camera", "camera", {"source=" + server.url()});
    auto application = swarm.application();
    const auto images = application.collect({{"camera", "image"}});
    REQUIRE(images->next(patient(20'000ms)));
    server.kill();
    CHECK(eventually([&] { return !condition_of(application).empty(); }, 20'000ms));
    while (images->next(0ms)) {
    }
    const RtspServer again(swarm, rtsp_port(8), "30");
    const auto event = images->next(patient(20'000ms));
    REQUIRE_MESSAGE(event, condition_of(application));
    CHECK(event->age() < patient(2000ms));
}
