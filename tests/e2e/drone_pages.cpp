// Runs the commands on the drones' pages unchanged: every indented line of a README in drones/, in order, each page in
// its own swarm. One list has the preparations and the few replaced words.
#include "free_port.hpp"
#include "onnx_writer.hpp"
#include "reader.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <algorithm>
#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

namespace fs = std::filesystem;

struct Page {
    std::string folder;
    std::string before;                                      ///< what the reader has done before
    std::vector<std::pair<std::string, std::string>> other;  ///< words of the page, and their replacements
};

const std::string recording = "hivectl start camera; hivectl start face; hivectl connect camera face\n"
                              "hivectl results face -n 1 > first.log\n"
                              "hivectl record camera face.faces -n 40 -o run.hive; hivectl stop --all\n";

// Needs hardware: without it the command must be refused.
const std::string set_device = "if [ -e /dev/video0 ]; then hivectl set cam source=/dev/video0 width=1280 height=720\n"
                               "else hivectl set cam source=/dev/video0 width=1280 height=720 || [ $? = 5 ]; fi";

// Replaces ports by free ones, and a network camera by the emulated one.
const std::vector<Page> pages{
    {"annotate", "", {}},
    {"axis",
     "mkdir -p .config/hive; echo root:pass > .config/hive/door-camera; chmod 600 "
     ".config/hive/door-camera\n" HIVE_SOURCE_DIR "/tests/support/axis_camera.py port=$port1 auth=digest &\n"
     "until (: < /dev/tcp/127.0.0.1/$port1) 2> /dev/null; do sleep 0.05; done\n",
     {{"http://192.0.2.10", "http://127.0.0.1:$port1 allow_address=127.0.0.1"}}},
    {"background", "", {}},
    {"camera",
     "hivectl start camera; mkdir images; hivectl snap camera images/1.jpg; hivectl stop camera\n",
     {{"hivectl set cam source=/dev/video0 width=1280 height=720", set_device}}},
    {"detect", "", {}},
    {"edges", "hivectl start camera\n", {}},
    {"face", "", {}},
    {"gesture", "", {}},
    {"record", "", {}},
    {"replay", recording, {}},
    {"track", "", {}},
    {"view", "", {{"8080", "$port1"}}},
    {"zones", "", {}},
    {"write",
     "hivectl start camera; hivectl save camera clip.mp4 -n 20; hivectl stop camera\n"
     "hivectl start camera --as other; hivectl start face; hivectl connect other face\n",
     {}},
};

/// The indented lines, which are commands, outside of fenced blocks.
std::string commands_on(const fs::path& page)
{
    std::ifstream in(page);
    std::string commands;
    bool fenced = false;
    for (std::string line; std::getline(in, line);) {
        fenced = line.starts_with("```") ? !fenced : fenced;
        if (!fenced && line.starts_with("    "))
            commands += line.substr(4) + "\n";
    }
    return commands;
}

std::string replaced(std::string text, const std::string& from, const std::string& to)
{
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

/// Retries while a server starts; reports the failing command.
constexpr auto patient_reader = R"(
trap 'kill $(jobs -p) 2> /dev/null || true' EXIT
trap 'echo "failed: $BASH_COMMAND" >&2' ERR
curl() { command curl --silent --show-error --fail --retry 20 --retry-delay 1 --retry-connrefused "$@"; }
)";

/// A virtual screen, if Xvfb is installed; without it, or if a sanitizer would report leaks of the window's library, no
/// window is opened.
std::string screen_for(const Page& page)
{
    if (page.folder != "view")
        return "";
    if (!sanitized() && fs::exists("/usr/bin/Xvfb"))
        return "Xvfb -displayfd 3 -screen 0 800x600x24 -nolisten tcp 3> screen 2> /dev/null &\n"
               "until [ -s screen ]; do sleep 0.05; done; export DISPLAY=:$(cat screen)\n";
    MESSAGE("not tried: the window of hivectl view, which needs Xvfb");
    return "eval \"run_$(declare -f hivectl)\"\n"
           "hivectl() { [ \"$*\" = 'view face.annotated' ] || run_hivectl \"$@\"; }\n";
}

void run_page(const std::string& folder)
{
    const auto page = *std::ranges::find(pages, folder, &Page::folder);
    auto commands = commands_on(fs::path(HIVE_SOURCE_DIR) / "drones" / folder / "README.md");
    REQUIRE_FALSE(commands.empty());
    for (const auto& [from, to] : page.other) {
        REQUIRE_MESSAGE(commands.find(from) != std::string::npos, from, " is on the page no more");
        commands = replaced(commands, from, to);
    }
    const Swarm swarm;
    const onnx::File model(".onnx", onnx::bytes_of({8, 8, {1, 5, 7}, std::vector<float>(35, 0.0F), {}}));
    fs::copy_file(model.path(), swarm.home() / "yolov8n.onnx");
    std::ofstream(swarm.home() / "coco.names") << "person\n";
    const auto script = "port1=" + std::to_string(free_port()) + " port2=" + std::to_string(free_port())
                        + " HOME=$PWD\n" + patient_reader + screen_for(page) + "of_reader=$timeout timeout=60\n"
                        + page.before + "\ntimeout=$of_reader\n" + commands;
    const auto finished = run_as_reader(swarm, script, sanitized() ? 10 : 1);
    CHECK_MESSAGE(finished.exit_code == 0, "exit code ", finished.exit_code, " of\n", commands, "\nit printed\n",
                  finished.out, finished.err);
}

}  // namespace

TEST_CASE("pages: every page in drones/ that has commands is run here")
{
    const fs::path drones = fs::path(HIVE_SOURCE_DIR) / "drones";
    for (const auto& file : fs::recursive_directory_iterator(drones))
        if (file.path().filename() == "README.md" && !commands_on(file.path()).empty()) {
            const auto folder = fs::relative(file.path().parent_path(), drones).string();
            CHECK_MESSAGE(std::ranges::count(pages, folder, &Page::folder) == 1, folder, " is not in the list");
        }
}

TEST_CASE("pages: the commands on the page of annotate work as they stand there") { run_page("annotate"); }
TEST_CASE("pages: the commands on the page of axis work as they stand there") { run_page("axis"); }
TEST_CASE("pages: the commands on the page of background work as they stand there") { run_page("background"); }
TEST_CASE("pages: the commands on the page of camera work as they stand there") { run_page("camera"); }
TEST_CASE("pages: the commands on the page of detect work as they stand there") { run_page("detect"); }
TEST_CASE("pages: the commands on the page of edges work as they stand there")
{
    if (possible(fs::exists(Swarm().program("hive-edges")) ? "" : "a build with drones in Python"))
        run_page("edges");
}
TEST_CASE("pages: the commands on the page of face work as they stand there") { run_page("face"); }
TEST_CASE("pages: the commands on the page of gesture work as they stand there") { run_page("gesture"); }
TEST_CASE("pages: the commands on the page of record work as they stand there") { run_page("record"); }
TEST_CASE("pages: the commands on the page of replay work as they stand there") { run_page("replay"); }
TEST_CASE("pages: the commands on the page of track work as they stand there") { run_page("track"); }
TEST_CASE("pages: the commands on the page of view work as they stand there") { run_page("view"); }
TEST_CASE("pages: the commands on the page of write work as they stand there") { run_page("write"); }
TEST_CASE("pages: the commands on the page of zones work as they stand there") { run_page("zones"); }
