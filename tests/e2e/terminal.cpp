// hivectl as people type it: on a terminal of a certain width.
#include "swarm.hpp"

#include <doctest/doctest.h>

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
