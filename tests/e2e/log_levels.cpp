// Shows which lines of a drone's life each --log-level writes.
#include "measure.hpp"

#include <doctest/doctest.h>
#include <raw_peer.hpp>

#include <algorithm>
#include <array>
#include <csignal>
#include <sstream>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

constexpr std::array levels{"debug", "info", "warning", "error"};

struct Line {
    const char *level, *text;
};

/// All events of the worker, in order.
constexpr std::array life{Line{"info", "started"},
                          Line{"warning", "refused image from source.nothing: "},
                          Line{"debug", "connected image from source.tick"},
                          Line{"error", "exception: failed: event "},
                          Line{"warning", "closed pid "},
                          Line{"warning", "lost image from source.tick"},
                          Line{"info", "stopped"}};

std::size_t rank(const std::string& level)
{
    return static_cast<std::size_t>(std::ranges::find(levels, level) - levels.begin());
}

/// "LEVEL TEXT" of each line of a worker's log, without its time and its name.
std::vector<std::string> lines_of(const Swarm& swarm, const std::string& name)
{
    std::vector<std::string> lines;
    std::istringstream log(swarm.log(name));
    for (std::string line, time, level; std::getline(log, line);) {
        std::istringstream fields(line);
        fields >> time >> level;
        const auto begin = line.find(name + ": ");
        lines.push_back(level + " "
                        + (begin == std::string::npos ? "not a line: " + line : line.substr(begin + name.size() + 2)));
    }
    return lines;
}

std::size_t times(const std::vector<std::string>& lines, const Line& wanted)
{
    return static_cast<std::size_t>(
        std::ranges::count_if(lines, [start = std::string(wanted.level) + " " + wanted.text](const auto& line) {
            return line.starts_with(start);
        }));
}

/// Runs the worker through these events and returns the lines of its log.
std::vector<std::string> live(const std::string& level)
{
    const Swarm swarm;
    auto application = swarm.application();
    auto source = swarm.drone("ticker", "source", {"fps=100"});
    auto worker =
        swarm.drone("sleeper", "worker", {"throw_at=1"}, {"--log-level", level, "--connect", "image=source.nothing"});
    const auto input = [&](const auto& is_so) {
        REQUIRE(eventually([&] { return std::ranges::any_of(application.status("worker").inputs, is_so); }));
    };
    input([](const auto& each) { return each.why == hive::Reason::refused; });
    application.disconnect({"source", "nothing"}, {"worker", "image"});
    application.connect({"source", "tick"}, {"worker", "image"});
    REQUIRE(eventually([&] { return application.status("worker").last_exception.has_value(); }));
    auto peer = raw::Peer::dial(swarm.home() / "worker.sock");
    peer.send("this is no packet at all");
    REQUIRE(peer.closed_within(patient(2000ms)));
    source.kill();
    input([](const auto& each) { return !each.connected; });
    worker.signal(SIGTERM);
    REQUIRE(worker.wait(patient(5000ms)) == 0);
    return lines_of(swarm, "worker");
}

/// "LEVEL TEXT" of the first line with this part; empty: none.
std::string line_with(const Swarm& swarm, const std::string& name, const std::string& part)
{
    for (const auto& line : lines_of(swarm, name))
        if (has(line, part))
            return line;
    return {};
}

}  // namespace

TEST_CASE("log level: each writes the lines of its level and of those above it, and no others")
{
    for (const std::string level : {"debug", "info", "warning", "error", "off"}) {
        CAPTURE(level);
        const auto lines = live(level);
        for (const auto& line : lines)
            CHECK_MESSAGE((rank(line.substr(0, line.find(' '))) >= rank(level) && level != "off"), line);
        for (const auto& line : life) {
            CAPTURE(std::string(line.text));
            CHECK(times(lines, line) == (level != "off" && rank(line.level) >= rank(level) ? 1 : 0));
        }
        if (level == "info")
            CHECK(lines.size() == 6);
        if (level == "warning")
            CHECK(lines.size() == 4);
        if (level == "error")
            CHECK(lines.size() == 1);
    }
}

TEST_CASE(
    "log level: a receiver that crashes is a warning of its sender, one that stops or is only an application is not")
{
    const Swarm swarm;
    auto application = swarm.application();
    const auto source = swarm.drone("ticker", "source", {"fps=100"}, {"--log-level", "debug"});
    const auto receives = [&](const std::string& name) {
        return eventually([&] {
            const auto inputs = application.status(name).inputs;
            return !inputs.empty() && inputs.front().connected;
        });
    };
    auto crashes = swarm.drone("sleeper", "crashes", {}, {"--connect", "image=source.tick"});
    auto stops = swarm.drone("sleeper", "stops", {}, {"--connect", "image=source.tick"});
    REQUIRE(receives("crashes"));
    REQUIRE(receives("stops"));
    crashes.kill();
    stops.signal(SIGTERM);
    REQUIRE(stops.wait(patient(5000ms)) == 0);
    CHECK(line_with(swarm, "source", "opened link to crashes at pid ").starts_with("debug "));
    CHECK(eventually(
        [&] { return line_with(swarm, "source", "lost receiver crashes at pid ").starts_with("warning "); }));
    CHECK(eventually([&] { return line_with(swarm, "source", "closed link to stops at pid ").starts_with("debug "); }));
    swarm.hivectl_done({"ps"});
    CHECK(eventually([&] { return line_with(swarm, "source", "closed link to app-").starts_with("debug "); }));
    CHECK(line_with(swarm, "source", "lost receiver stops") == "");
}
