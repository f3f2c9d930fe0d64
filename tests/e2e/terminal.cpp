// hivectl as people type it: on a terminal of a certain width.
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <fstream>
#include <sstream>

using namespace hive::test;

namespace {

/// What stands on the terminal in the end. Ctrl-C is pressed once `text` was printed, if that is not empty.
Finished on_terminal(const Swarm& swarm, const std::vector<std::string>& words, const std::string& text = "",
                     const std::string& variable = "NO_COLOR=1")
{
    std::vector<std::string> line{
        "/usr/bin/env", variable, "TERM=xterm", "python3", HIVE_SOURCE_DIR "/tests/support/terminal.py", "80", text};
    line.insert(line.end(), words.begin(), words.end());
    return swarm.run(line, Milliseconds(40'000));
}

/// In characters.
std::size_t longest_line(const std::string& text)
{
    std::size_t longest = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        longest = std::max(longest, static_cast<std::size_t>(std::ranges::count_if(
                                        line, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; })));
    return longest;
}

}  // namespace

TEST_CASE("terminal: tables fit its 80 columns, --wide and pipes have them whole")
{
    const Swarm swarm;
    const auto camera = swarm.drone("ticker", "camera");
    const auto face = swarm.drone("counter", "face");
    swarm.hivectl_done({"connect", "camera", "face"});
    const auto whole = swarm.hivectl_done({"describe", "camera"});
    REQUIRE(longest_line(whole) > 80);
    CHECK(longest_line(on_terminal(swarm, {"hivectl", "describe", "camera"}).out) <= 80);
    CHECK(on_terminal(swarm, {"hivectl", "describe", "camera", "--wide"}).out == whole);
    const auto edges = on_terminal(swarm, {"hivectl", "edges"}).out;
    CHECK(longest_line(edges) <= 80);
    CHECK(has(edges, "camera.tick\n  TO face."));
}

TEST_CASE("terminal: states are coloured, but not with NO_COLOR, nor elsewhere")
{
    const Swarm swarm;
    const auto camera = swarm.drone("sleeper", "camera");
    CHECK(has(on_terminal(swarm, {"hivectl", "ps"}, "", "X=").out, "\x1b[32midle\x1b[0m"));
    CHECK_FALSE(has(on_terminal(swarm, {"hivectl", "ps"}).out, "\x1b["));
    CHECK_FALSE(has(swarm.hivectl_done({"ps"}), "\x1b["));
}

TEST_CASE("terminal: after a second, the status line says what is waited for, and goes when that is over")
{
    const Swarm swarm;
    const auto never = on_terminal(swarm, {"hivectl", "wait", "nobody", "--timeout", "1.5"}).out;
    CHECK(has(never, "\rwaiting for nobody to be running (now gone), 1 s\x1b[K\r\x1b[Khivectl wait: nobody"));
    CHECK_FALSE(has(swarm.hivectl({"wait", "nobody", "--timeout", "1.5"}).err, "waiting"));
    const auto soon = on_terminal(swarm, {"hivectl", "wait", "nobody", "--timeout", "0.5"}).out;
    CHECK_FALSE(has(soon, "waiting"));
    const auto slow = swarm.drone("sleeper", "slow", {"work_ms=0"});
    CHECK(has(on_terminal(swarm, {"hivectl", "snap", "slow", "x.jpg", "--timeout", "1.5"}).out, "waiting for slow."));
}

TEST_CASE("terminal: start and up say which drone is not ready yet")
{
    const Swarm swarm;
    const auto start = on_terminal(swarm, {"hivectl", "start", "sleeper", "start_ms=1500"}).out;
    CHECK(has(start, "waiting for sleeper to be ready, 1 s"));
    CHECK(start.ends_with("\r\x1b[Ksleeper\n"));
    const auto file = swarm.home() / "two.json";
    std::ofstream(file) << R"({"swarm": "two", "drones": {"soon": {"kind": "sleeper"},
                               "late": {"kind": "sleeper", "set": {"start_ms": 1500}}}})";
    const auto up = on_terminal(swarm, {"hivectl", "up", file}).out;
    CHECK(has(up, "waiting for late (1 of 2 started), 1 s"));
}

TEST_CASE("terminal: Ctrl-C leaves no status line")
{
    const Swarm swarm;
    const auto ended = on_terminal(swarm, {"hivectl", "wait", "nobody"}, "1 s");
    CHECK(ended.exit_code == 130);
    CHECK(ended.out.ends_with("\r\x1b[K"));
}

TEST_CASE("stop: several drones are stopped together")
{
    const Swarm swarm;
    std::vector<Process> drones;
    for (const std::string name : {"a", "b", "c"}) {
        drones.push_back(swarm.drone("sleeper", name));
        kill(drones.back().pid(), SIGSTOP);
    }
    const auto begin = std::chrono::steady_clock::now();
    const auto stopped = swarm.hivectl({"stop", "a", "b", "c", "--timeout", "1"});
    CHECK(stopped.exit_code != 0);
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(2500));
}
