// The memory of hivectl dash, of a view drone and of their camera with ten viewers each is flat. $HIVE_VIEWERS_SECONDS
// says for how long it is measured: 20 s; the requirement is an hour.
#include "dash_server.hpp"

#include <doctest/doctest.h>
#include <free_port.hpp>

#include <cstdlib>
#include <map>
#include <thread>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

constexpr int viewers = 10, streams = 8;  // a view drone serves 8 of these

std::chrono::seconds measured_for()
{
    const char* const seconds = std::getenv("HIVE_VIEWERS_SECONDS");
    return std::chrono::seconds(seconds ? std::atoi(seconds) : 20);
}

double megabytes(std::size_t bytes) { return static_cast<double>(bytes) / 1e6; }

/// The events of a page in a browser.
std::string events_of(const Page& page)
{
    return "exec curl -sfN -o /dev/null -b " + page.cookie() + " " + page.address() + "/events";
}

/// Its other requests, until one has a wrong answer: images and the graph, which may not exist yet, and the details of
/// a drone.
std::string requests_of(const Page& page, double pause)
{
    const auto get = "curl -sf -m 30 -b " + page.cookie();
    const auto each = [&](const std::string& path) { return " -o /dev/null " + page.address() + path; };
    return "while sleep " + std::to_string(pause) + "; do " + get + each("/image/camera.image/320/0")
           + each("/graph.svg") + "; " + get + " --fail-early" + each("/drone/camera") + each("/ask/camera")
           + " || exit 1; done";
}

}  // namespace

TEST_CASE("viewers: with ten of them the memory of dash and view does not grow")
{
    const Swarm swarm;
    const auto port = free_port();
    const std::string token(32, 't');
    const auto camera = swarm.drone("camera", "camera", {"source=scene", "fps=15"}),
               view = swarm.drone("view", "view", {"http=" + std::to_string(port), "token=" + token}, {}, {"DISPLAY="});
    swarm.hivectl_done({"connect", "camera", "view"});
    const Page page(swarm);
    REQUIRE(eventually([&] { return page.get("/drone/camera").ends_with("200"); }));  // 404 before the first look
    const auto stream =
        "exec curl -sfN -o /dev/null 'http://127.0.0.1:" + std::to_string(port) + "/stream.mjpg?token=" + token + "'";
    std::vector<Process> browsers;
    for (int i = 0; i < viewers; ++i) {
        std::vector lines{events_of(page), requests_of(page, measured_for() > 1min ? 2 : 0.2)};
        if (i < streams)
            lines.push_back(stream);
        for (const auto& line : lines)
            browsers.emplace_back(std::vector<std::string>{"/bin/sh", "-c", line}, std::vector<std::string>{},
                                  swarm.home() / "browsers");
    }

    const std::map<std::string, pid_t> programs{{"dash", page.pid()}, {"view", view.pid()}, {"camera", camera.pid()}};
    std::map<std::string, std::size_t> before, after;  // the most in the second and in the last third
    const auto begin = std::chrono::steady_clock::now(), end = begin + measured_for();
    for (auto now = begin; now < end; now = std::chrono::steady_clock::now()) {
        const auto third = 3 * (now - begin) / (end - begin);
        for (const auto& [name, pid] : programs)
            if (third > 0) {
                auto& most = (third == 1 ? before : after)[name];
                most = std::max(most, resident_bytes(pid));
            }
        std::this_thread::sleep_for(200ms);
    }
    for (const auto& [name, pid] : programs) {
        constexpr double growth = 4;  // megabytes: pages that are touched late
        MESSAGE(name, ": ", megabytes(before[name]), " MB, then ", megabytes(after[name]), " MB");
        CHECK(before[name] > 0);
        CHECK(megabytes(after[name]) <= megabytes(before[name]) + growth);
    }
    for (auto& browser : browsers)
        CHECK(!browser.wait(0ms));  // it looked until the end
}
