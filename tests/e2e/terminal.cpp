// hivectl at a terminal: with a certain width, and with typing errors.
#include "fake_ssh.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

using namespace hive::test;

namespace {

/// The final content of the terminal. Presses Ctrl-C once `text` was printed, if that is not empty.
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
    const auto edges = on_terminal(swarm, {"hivectl", "connections"}).out;
    CHECK(longest_line(edges) <= 80);
    CHECK(has(edges, "STATE"));
    CHECK_FALSE(has(edges, "ACKNOWLEDGED"));
    CHECK(has(on_terminal(swarm, {"hivectl", "connections", "--wide"}).out, "ACKNOWLEDGED"));
}

TEST_CASE("terminal: states are coloured, but not with NO_COLOR, nor elsewhere")
{
    const Swarm swarm;
    const auto camera = swarm.drone("sleeper", "camera");
    const auto source = swarm.drone("ticker", "source");
    CHECK(has(on_terminal(swarm, {"hivectl", "ps", "source"}, "", "X=").out, "\x1b[32msending\x1b[0m"));
    CHECK(has(swarm.hivectl_done({"ps", "source"}), "idle"));
    CHECK(has(on_terminal(swarm, {"hivectl", "ps"}, "", "X=").out, "\x1b[32midle\x1b[0m"));
    CHECK_FALSE(has(on_terminal(swarm, {"hivectl", "ps"}).out, "\x1b["));
    CHECK_FALSE(has(swarm.hivectl_done({"ps"}), "\x1b["));
}

TEST_CASE("terminal: after a second, the status line says what is waited for, and goes when that is over")
{
    const Swarm swarm;
    const auto never = on_terminal(swarm, {"hivectl", "wait", "nobody", "--timeout", "1.5"}).out;
    CHECK(has(never, "\rwaiting for nobody to be running (now gone), 1 s\x1b[K\r\x1b[Khivectl wait: nobody is not "
                     "running after 1.5 s"));
    CHECK_FALSE(has(swarm.hivectl({"wait", "nobody", "--timeout", "1.5"}).err, "waiting"));
    const auto soon = on_terminal(swarm, {"hivectl", "wait", "nobody", "--timeout", "0.5"}).out;
    CHECK_FALSE(has(soon, "waiting"));
    const auto hung = swarm.drone("sleeper", "hung");
    hung.signal(SIGSTOP);
    const std::string drone = "waiting for hung to answer, 1 s", any = "waiting for drones to answer, 1 s";
    for (const auto& [verb, text] : std::vector<std::pair<std::vector<std::string>, std::string>>{
             {{"set", "hung", "work_ms=1"}, drone},
             {{"get", "hung"}, drone},
             {{"describe", "hung"}, drone},
             {{"put", "hung", HIVE_SOURCE_DIR "/libhive/docs/demo.jpg"}, drone},
             {{"snap", "hung", "x.jpg"}, drone},
             {{"results", "hung"}, drone},
             {{"halt", "hung"}, drone},
             {{"record", "hung", "-o", "a.hive"}, any},
             {{"exceptions", "hung"}, any},
             {{"export"}, any}}) {
        std::vector<std::string> words{"hivectl", "--timeout", "2.5"};
        words.insert(words.begin() + 1, verb.begin(), verb.end());
        const auto shown = on_terminal(swarm, words).out;
        CHECK_MESSAGE(has(shown, text), words[1], " shows ", shown);
        CHECK(has(shown, "\x1b[K\r\x1b[Khivectl"));
    }
    const auto slow = swarm.drone("sleeper", "slow", {"work_ms=0"});
    CHECK(has(on_terminal(swarm, {"hivectl", "snap", "slow", "x.jpg", "--timeout", "2.5"}).out, "waiting for slow."));
    CHECK(has(on_terminal(swarm, {"hivectl", "replace", "slow", "start_ms=2500"}).out,
              "waiting for slow to be ready, 1 s"));
    CHECK(
        has(on_terminal(swarm, {"hivectl", "stop", "hung", "--timeout", "2.5"}).out, "waiting for hung to exit, 1 s"));
}

TEST_CASE("terminal: results into a file say how far the source is, and so does ps")
{
    const Swarm swarm;
    const auto folder = swarm.home() / "frames";
    std::filesystem::create_directory(folder);
    for (int i = 10; i < 40; ++i)
        std::filesystem::copy(HIVE_SOURCE_DIR "/libhive/docs/demo.jpg", folder / (std::to_string(i) + ".jpg"));
    const auto face = swarm.drone("face", "face", {"scale=1.05"});
    const auto camera = swarm.drone("camera", "camera", {"source=" + folder.string(), "loop=false", "pace=demand"});
    swarm.hivectl_done({"connect", "camera", "face"});
    const auto file = (swarm.home() / "r.json").string();
    const auto shown = on_terminal(swarm, {"sh", "-c", "hivectl results face.faces > " + file}).out;
    CHECK_MESSAGE(has(shown, " of 30 frames, "), shown);
    CHECK(shown.ends_with("\r\x1b[K"));
    CHECK(has(on_terminal(swarm, {"hivectl", "ps", "camera"}).out, "30 of 30"));
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
    const auto slow = swarm.home() / "slow.py", one = swarm.home() / "one.json";
    std::ofstream(slow) << "import time\ntime.sleep(1.5)\n";
    std::ofstream(one) << R"({"swarm": "one", "drones": {"slow": {"kind": ")" << slow.string() << R"("}}})";
    CHECK(has(on_terminal(swarm, {"hivectl", "check", one}).out,
              "waiting for the programs of the drones to describe themselves, 1 s"));
}

TEST_CASE("terminal: what another machine is asked for is on the status line")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    const auto shown = [&](const std::vector<std::string>& words) {
        return on_terminal(here, ssh.words(words), "", "SSH_PAUSE=1.3").out;
    };
    const auto start = shown({"start", "ticker", "--on", "me@gpu1", "--insecure"});
    CHECK_MESSAGE(has(start, "waiting for ticker to be ready on me@gpu1, 1 s"), start);
    const auto log = shown({"logs", "ticker"});
    CHECK_MESSAGE(has(log, "waiting for the log of ticker on gpu1, 1 s\x1b[K\r\x1b[K"), log);
    CHECK(has(log, "listening on tcp://"));
    here.hivectl_done({"stop", "ticker"});
}

TEST_CASE("terminal: after Ctrl-C, save says that it waits for the file")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=scene"});
    const std::jthread at_the_keyboard([&] {
        pid_t writer = 0;
        CHECK(eventually([&] {
            const auto answer = swarm.application().status(std::vector<std::string>{"writer"}).at(0);
            const auto status = value_or_none(answer.status);
            writer = static_cast<pid_t>(status.pid);
            return !status.inputs.empty() && status.inputs.at(0).processed > 5;
        }));
        if (writer <= 0)
            return;  // kill(0) would stop the test itself
        ::kill(writer, SIGSTOP);
        std::ifstream stat("/proc/" + std::to_string(writer) + "/stat");
        std::string word, parent;
        stat >> word >> word >> word >> parent;
        ::kill(std::stoi(parent), SIGINT);
    });
    const auto file = (swarm.home() / "a.mp4").string();
    const auto shown = on_terminal(swarm, {"hivectl", "save", "camera", file, "--timeout", "2.5"}).out;
    CHECK_MESSAGE(has(shown, "waiting for the file to be completed, 1 s"), shown);
}

TEST_CASE("terminal: the rate of a recording is that since its start, however long the source was running before")
{
    const Swarm swarm;
    const auto camera = swarm.drone("ticker", "camera", {"fps=100"});
    swarm.hivectl_done({"results", "camera.tick", "-n", "400"});
    const auto file = swarm.home() / "a.hive";
    const auto shown = on_terminal(swarm, {"hivectl", "record", "camera", "-o", file, "-n", "100"}).out;
    const auto end = shown.find("/s");
    REQUIRE(end != std::string::npos);
    CHECK(std::stod(shown.substr(shown.rfind(' ', end))) < 400);
    CHECK(std::stoi(shown.substr(shown.find('\r') + 1)) <= 100);  // and so is the number
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
    CHECK_MESSAGE(stopped.exit_code == 0, stopped.err);  // hanging drones are killed
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(2500));
}

TEST_CASE("command line: a wrong option of a drone is exit code 2, and the message has the names of both")
{
    const Swarm swarm;
    const auto wrong = swarm.run({swarm.program("hive-ticker"), "--nope"});
    CHECK(wrong.exit_code == 2);
    CHECK(wrong.err == "hive-ticker: no option \"--nope\"; see hive-ticker --help\n");
    const auto value = swarm.run({swarm.program("hive-ticker"), "--on-exception", "stop"});
    CHECK(value.exit_code == 2);
    CHECK(has(value.err, "hive-ticker: --on-exception: "));
    CHECK(swarm.run({swarm.program("hive-ticker"), "--version"}).exit_code == 0);
}

TEST_CASE("command line: what is wrong with an option is said in one voice")
{
    const Swarm swarm;
    for (const auto& [words, text] : std::vector<std::pair<std::vector<std::string>, std::string>>{
             {{"ps", "--nope"}, "no option \"--nope\""},
             {{"snap", "a", "b", "c"}, "unexpected argument \"c\""},
             {{"connect", "a", "b", "--window"}, "--window needs a value"},
             {{"connect", "a", "b", "--window", "99"}, "--window: \"99\" is not a number from 1 to 64"},
             {{"export", "--as", "x"}, "--as: \"x\" is not systemd, compose, kubernetes, slurm or shell"},
             {{"export", "--swarm", "a", "--from", "b"}, "--swarm cannot be combined with --from"},
             {{"export", "--set", "a=1"}, "--set is only used with --from"},
             {{"export", "--image", "a"}, "--image is only used with --as"},
             {{"results", "a", "--sync", "--window", "3"}, "--sync cannot be combined with --window"},
             {{"ps", "--timeout", "5x"}, "--timeout: \"5x\" is not written as 2, 500ms or 2min"},
             {{"ps", "--timeout", "0ms"}, "--timeout: \"0ms\" is too small"},
             {{"exceptions", "-n", "3"}, "-n is only used with --follow"}}) {
        const auto wrong = swarm.hivectl(words);
        CHECK(wrong.exit_code == 2);
        CHECK(wrong.err == "hivectl " + words[0] + ": " + text + "; see hivectl " + words[0] + " --help\n");
    }
}

TEST_CASE("command line: advice has the names that are known, and nobody is left without any")
{
    const Swarm swarm;
    const auto drone = swarm.drone("sleeper", "face");
    CHECK(has(swarm.hivectl({"set", "face", "nope=1"}).err, "hivectl describe face\n"));
    CHECK(has(swarm.hivectl({"connect", "face", "face.nope"}).err, "see its ports: hivectl describe face\n"));
    CHECK(swarm.hivectl({"connect", "a", "face"}).err
          == "hivectl connect: a is not running; see what runs: hivectl ps\n");
    CHECK(swarm.hivectl({"wait", "sleeper-2", "--timeout", "0.1"}).err
          == "hivectl wait: sleeper-2 is not running after 100 ms; start it: hivectl start sleeper --as sleeper-2\n");
    const Swarm empty;
    CHECK(empty.hivectl({"ps"}).err
          == "hivectl ps: no drones in " + empty.home().string() + "; start one: hivectl start KIND\n");
    const auto exported = empty.hivectl({"export", "--as", "compose"});
    CHECK(exported.exit_code == 3);
    CHECK(exported.out.empty());
}

TEST_CASE("wait: a glob stands for the drones that run now, and none of them are gone")
{
    const Swarm swarm;
    const auto one = swarm.drone("sleeper", "w1"), two = swarm.drone("sleeper", "w2");
    CHECK(swarm.hivectl_done({"wait", "w*", "--json"})
          == "{\"drone\":\"w1\",\"reached\":\"running\"}\n{\"drone\":\"w2\",\"reached\":\"running\"}\n");
    const auto stay = swarm.hivectl({"wait", "w?", "--for", "gone", "--timeout", "100ms"});
    CHECK(stay.exit_code == 124);
    CHECK(has(stay.err, "w1 is not gone after 100 ms"));
    const auto none = swarm.hivectl({"wait", "x*", "w*"});
    CHECK(none.exit_code == 3);
    CHECK(none.err
          == "hivectl wait: no running drone matches \"x*\"; to wait for one that does not run yet, give its name\n");
    swarm.hivectl_done({"stop", "w*"});
    CHECK(swarm.hivectl_done({"wait", "w*", "--for", "gone"}).empty());
}

TEST_CASE("command line: a time and a size may have a unit")
{
    const Swarm swarm;
    const auto drone = swarm.drone("ticker", "camera");
    const auto waited = swarm.hivectl({"wait", "nobody", "--timeout", "100ms"});
    CHECK(waited.exit_code == 124);
    CHECK(has(waited.err, "after 100 ms"));
    const auto file = (swarm.home() / "a.hive").string();
    CHECK(swarm.hivectl({"record", "camera", "-o", file, "-n", "1", "--max-size", "2GB", "--for", "1min"}).exit_code
          == 0);
    const auto other = swarm.drone("ticker", "other");
    CHECK(swarm.hivectl({"collect", "camera.tick", "other.tick", "--within", "1s", "--notify", "-n", "1"}).exit_code
          == 0);
}

TEST_CASE("completion: drones of the tests are not offered, though they can be started")
{
    const Swarm swarm;
    CHECK(swarm.hivectl_done({"complete", "--", "start", "cam"}) == "camera\n");
    for (const char* kind : {"ticker", "sleeper", "counter", "crasher", "breaker", "fork", "join"})
        CHECK(swarm.hivectl_done({"complete", "--", "start", kind}).empty());
}

TEST_CASE("completion: it knows the values of options, arguments and parameters")
{
    const Swarm swarm;
    const auto drone = swarm.drone("ticker", "camera");
    const auto offered = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"complete", "--"});
        return swarm.hivectl_done(words);
    };
    CHECK(offered({"export", "--as", "s"}) == "systemd\nslurm\nshell\n");
    CHECK(offered({"export", "--as=c"}) == "--as=compose\n");
    CHECK(offered({"connect", "a", "b", "--encoding", "p"}) == "png\n");
    CHECK(offered({"key", "r"}) == "rotate\n");
    CHECK(offered({"set", "camera", "pa"}) == "padding=\npace=\n");
    CHECK(offered({"set", "camera", "pace="}) == "pace=live\npace=demand\n");
    CHECK(offered({"set", "camera", "ends=t"}) == "ends=true\n");
    CHECK(offered({"start", "ticker", "pa"}) == "padding=\npace=\n");
    CHECK(offered({"start", "ticker", "--as", "other", "count=3", "pace=d"}) == "pace=demand\n");
    CHECK(offered({"start", "nothing", "pa"}).empty());
    CHECK(offered({"replace", "camera", "pa"}) == "padding=\npace=\n");
    CHECK(offered({"replace", "camera", "--kind", "cam"}) == "camera\n");
    CHECK(offered({"replace", "camera", "--kind=cam"}) == "--kind=camera\n");
    CHECK(offered({"replace", "camera", "--kind", "camera", "pa"}) == "pace=\n");
    CHECK(offered({"replace", "camera", "--kind=camera", "pa"}) == "pace=\n");
    CHECK(offered({"connections", "--w"}) == "--wide\n");
    const std::string bash =
        "source <(hivectl completion bash); COMP_WORDS=(hivectl set camera pace = d); COMP_CWORD=5; "
        "_hivectl; printf '%s\\n' \"${COMPREPLY[@]}\"";
    CHECK(swarm.run({"/bin/bash", "-c", bash}).out == "demand\n");
}
