// Failing starts, names and sources: nothing hangs, and every failure has its reason.
#include "measure.hpp"
#include "switched_off.hpp"

#include <mute_server.hpp>

#include <doctest/doctest.h>

#include <csignal>
#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

std::size_t times(const std::string& text, const std::string& part)
{
    std::size_t count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

}  // namespace

TEST_CASE("stall: a camera whose source is silent still answers, says that it is stalled, and takes another source")
{
    const Swarm swarm;
    const MuteServer server;
    const auto camera = swarm.drone("camera", "camera", {"source=" + server.url()});
    auto application = swarm.application();
    for (const auto& words : {std::vector<std::string>{"get", "camera", "fps"}, {"ps"}, {"describe", "camera"}}) {
        const auto took = median_ms(swarm, words, 5);
        MESSAGE("hivectl ", words[0], " of a camera with a silent source: ", took, " ms");
        CHECK(took < static_cast<double>(patient(2000ms).count()));  // the source may take 20 s to open
    }
    const auto begin = Clock::now();
    CHECK(eventually([&] { return !application.status("camera").condition.empty(); }, 6000ms));
    MESSAGE("condition after ", std::chrono::duration_cast<Milliseconds>(Clock::now() - begin).count(),
            " ms: ", application.status("camera").condition);
    const auto collector = application.collect({{"camera", "image"}});
    const auto set = swarm.hivectl({"set", "camera", "source=scene"});
    CHECK(set.exit_code == 0);
    CHECK(collector->next(patient(3000ms)));
    CHECK(eventually([&] { return application.status("camera").condition == ""; }));
    CHECK(swarm.hivectl({"stop", "camera"}).took < patient(3000ms));
}

TEST_CASE("silence: when nothing came, the sender's own reason is told")
{
    const Swarm swarm;
    const MuteServer server;
    const auto camera = swarm.drone("camera", "camera", {"source=" + server.url()});
    const auto ticker = swarm.drone("ticker", "ticker", {"fps=1000"});
    auto application = swarm.application();
    application.halt("ticker");
    std::string condition;  // at first it is stalled only
    REQUIRE(eventually([&] { return has(condition = application.status("camera").condition, server.url()); }, 6000ms));
    const auto file = (swarm.home() / "run.hive").string();
    for (const auto& words : {std::vector<std::string>{"results", "camera"},
                              {"collect", "camera", "ticker"},
                              {"record", "camera", "ticker", "-o", file}}) {
        CAPTURE(words[0]);
        auto all = words;
        all.insert(all.end(), {"--timeout", "2"});  // which is also the time to register
        std::string said;
        CHECK_MESSAGE(eventually([&] {  // a drone that does not answer within half a second has printed nothing
                          const auto before = application.status("camera").condition;
                          const auto silent = swarm.hivectl(all);
                          said = silent.err;
                          CHECK(silent.exit_code == 124);
                          return (has(said, "camera reports: " + before)
                                  || has(said, "camera reports: " + application.status("camera").condition))
                                 && (words[0] == "results" || has(said, "ticker has halted"));
                      }),
                      said);
    }
}

TEST_CASE("names: a second drone of the same name is refused, and told which process has it")
{
    const Swarm swarm;
    const auto first = swarm.drone("ticker", "twin", {"fps=50"});
    const auto pid = std::to_string(first.pid());
    const auto second = swarm.run({swarm.program("hive-sleeper").string(), "--name", "twin"});
    CHECK(second.exit_code == 1);
    CHECK(has(second.err, "twin"));
    CHECK(has(second.err, pid));
    const auto started = swarm.hivectl({"start", "sleeper", "--as", "twin"});
    CHECK(started.exit_code == 1);
    CHECK(has(started.err, "twin is running already"));
    CHECK(has(started.err, "or keep it: if_missing"));
    CHECK(swarm.hivectl_done({"start", "ticker", "--as", "twin", "--if-missing"}) == "twin\n");
    const auto other = swarm.hivectl({"start", "sleeper", "--as", "twin", "--if-missing"});
    CHECK(other.exit_code == 1);
    CHECK(has(other.err, "twin is running already; its kind is ticker, not sleeper; stop it: hivectl stop twin"));
    CHECK_FALSE(has(other.err, "if_missing"));
    CHECK(swarm.application().describe("twin").kind == "ticker");  // the first is unaffected
}

TEST_CASE("names: of several names those that run are served, and exit code 8 names the one that does not")
{
    const Swarm swarm;
    const auto first = swarm.drone("ticker", "one"), second = swarm.drone("ticker", "two");
    const auto ps = swarm.hivectl({"ps", "one", "gone", "--json"});
    CHECK(ps.exit_code == 8);
    CHECK(has(ps.err, "gone is not running"));
    CHECK(Json::parse(ps.out).at(0).at("name") == "one");
    for (const auto* verb : {"describe", "halt", "resume"}) {
        CAPTURE(verb);
        const auto asked = swarm.hivectl({verb, "gone", "one"});
        CHECK(asked.exit_code == 8);
        CHECK(has(asked.out, "one"));
    }
    const auto file = (swarm.home() / "run.hive").string();
    const std::vector<std::vector<std::string>> streaming{{"results", "one.tick", "one.tack", "gone.tick", "-n", "2"},
                                                          {"record", "one", "one.tack", "gone", "-n", "2", "-o", file},
                                                          {"exceptions", "gone", "one", "--follow", "--timeout", "0.1"},
                                                          {"exceptions", "gone", "one", "--on-exception", "skip"}};
    for (const auto& words : streaming) {
        CAPTURE(words[0]);
        const auto asked = swarm.hivectl(words);
        CHECK_MESSAGE(asked.exit_code == (words[3] == "--follow" ? 124 : 8), asked.err);
        CHECK(has(asked.err, "gone is not running"));
    }
    CHECK(has(swarm.hivectl({"results", "one.tack"}).err, "one has no output tack; did you mean tick?"));
    const auto stopped = swarm.hivectl({"stop", "one", "gone", "two"});
    CHECK(stopped.exit_code == 8);
    CHECK(stopped.out == "one\ntwo\n");
    CHECK(has(stopped.err, "gone"));
    CHECK(swarm.hivectl({"ps", "one", "two"}).exit_code == 3);
}

TEST_CASE("names: a name whose holder was killed is free at once")
{
    const Swarm swarm;
    auto first = swarm.drone("ticker", "heir");
    first.kill();
    CHECK(Json::parse(swarm.hivectl_done({"ps", "--json"})).empty());
    CHECK(swarm.hivectl({"get", "heir"}).exit_code == 3);
    CHECK(swarm.hivectl_done({"start", "sleeper", "--as", "heir"}) == "heir\n");
    CHECK(swarm.application().describe("heir").kind == "sleeper");
}

TEST_CASE("names: a name is free within 100 ms of its holder's death")
{
    const Swarm swarm;
    auto application = swarm.application();
    std::vector<Clock::duration> took;
    for (int i = 0; i < 7; ++i) {
        const auto holder = swarm.drone("ticker", "heir");
        const auto begin = Clock::now();
        ::kill(holder.pid(), SIGKILL);
        REQUIRE(eventually([&] { return application.drones().empty(); }));
        took.push_back(Clock::now() - begin);
    }
    MESSAGE("free after ", std::chrono::duration<double, std::milli>(median(took)).count(), " ms in the middle, ",
            std::chrono::duration<double, std::milli>(std::ranges::max(took)).count(), " ms at most");
    CHECK(std::ranges::min(took) < stated(100ms));
}

TEST_CASE("names: when nobody asks whether its holder lives, a name stays taken, and ps shows the dead")
{
    const SwitchedOff asking("living-holder");
    const Swarm swarm;
    auto first = swarm.drone("ticker", "heir");
    first.kill();
    CHECK(Json::parse(swarm.hivectl_done({"ps", "--json"})).size() == 1);
    const auto second = swarm.run({swarm.program("hive-sleeper").string(), "--name", "heir"});
    CHECK(second.exit_code == 1);
    CHECK(has(second.err, "heir runs already"));
}

TEST_CASE("state: what a drone was told is not for one of another kind with its name")
{
    const Swarm swarm;
    auto sleeper = swarm.drone("sleeper", "heir", {"work_ms=5"});
    swarm.hivectl_done({"set", "heir", "work_ms=6"});
    REQUIRE(eventually([&] { return has(text_of(swarm.home() / "heir.state"), "6"); }));
    sleeper.kill();
    const auto ticker = swarm.drone("ticker", "heir");
    CHECK(swarm.application().get("heir", {"count"}) == Json{{"count", 0}});
    CHECK(has(swarm.log("heir"), "sleeper"));
}

TEST_CASE("state: a saved value that is refused now is left out with a word, and the others are kept, and a file that "
          "is damaged is left out")
{
    const Swarm swarm;
    const auto file = swarm.home() / "heir.state";
    auto drone = swarm.drone("sleeper", "heir", {"work_ms=5", "throw_at=7"});
    drone.kill();
    Json state = Json::parse(text_of(file));
    state["parameters"].update({{"work_ms", -1}, {"colour", "red"}});
    std::ofstream(file, std::ios::trunc) << state;
    drone = swarm.drone("sleeper", "heir");
    CHECK(swarm.application().get("heir", {"work_ms", "throw_at"}) == Json{{"work_ms", 0}, {"throw_at", 7}});
    CHECK(has(swarm.log("heir"), "warning heir: ignored a saved value"));
    CHECK(has(swarm.log("heir"), "colour"));
    drone.kill();
    std::ofstream(file, std::ios::trunc) << "{\"kind\": \"slee";
    drone = swarm.drone("sleeper", "heir");
    CHECK(swarm.application().get("heir", {"throw_at"}) == Json{{"throw_at", 0}});
    CHECK(has(swarm.log("heir"), "cannot be read"));
}

TEST_CASE("state: a drone that cannot write it does what it is told, and says once what is wrong")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source");
    const auto worker = swarm.drone("sleeper", "worker");
    std::string in_the_way;
    SUBCASE("not even a new file") { in_the_way = "worker.state.new"; }
    SUBCASE("not in the place of the old one") { in_the_way = "worker.state"; }
    std::filesystem::remove(swarm.home() / in_the_way);
    std::filesystem::create_directory(swarm.home() / in_the_way);
    CHECK(swarm.hivectl_done({"set", "worker", "work_ms=5"}) == "5\n");
    CHECK(swarm.hivectl_done({"connect", "source", "worker"}) == "source.tick -> worker.image\n");
    CHECK(swarm.hivectl_done({"set", "worker", "work_ms=6"}) == "6\n");
    auto application = swarm.application();
    CHECK(eventually([&] {
        const auto exception = application.status("worker").last_exception;
        return exception && exception->code == "io";
    }));
    CHECK(application.status("worker").inputs.at(0).connected);
    CHECK(application.status("worker").pid == worker.pid());
    CHECK(times(swarm.log("worker"), in_the_way) == 1);
}

TEST_CASE("start: a drone whose further address is taken ends with the reason, and leaves nothing in its way")
{
    const Swarm swarm;
    const MuteServer server;
    const auto ended = swarm.run({swarm.program("hive-sleeper").string(), "--name", "face", "--listen",
                                  "tcp://127.0.0.1:" + server.port(), "--insecure"});
    CHECK(ended.exit_code == 1);
    CHECK(has(ended.err, server.port()));
    CHECK_FALSE(std::filesystem::exists(swarm.home() / "face.sock"));
    const auto drone = swarm.drone("sleeper", "face");
    CHECK(swarm.application().describe("face").kind == "sleeper");
}

TEST_CASE("start: a drone outlives the killed command that was starting it, answers, and can be stopped")
{
    const Swarm swarm;
    auto starter = swarm.hivectl_running({"start", "ticker", "fps=100"}, "starter");
    REQUIRE(eventually([&] { return std::filesystem::exists(swarm.home() / "ticker.lock"); }));
    starter.kill();
    CHECK(swarm.hivectl({"wait", "ticker", "--for", "running"}).exit_code == 0);
    CHECK(swarm.application().get("ticker", {"fps"}) == Json{{"fps", 100.0}});
    CHECK(swarm.hivectl({"stop", "ticker"}).exit_code == 0);
    CHECK(Json::parse(swarm.hivectl_done({"ps", "--json"})).empty());
}

TEST_CASE("start: an unknown kind is exit code 3 with the kinds there are")
{
    const Swarm swarm;
    const auto unknown = swarm.hivectl({"start", "camra"});
    CHECK(unknown.exit_code == 3);
    CHECK(has(unknown.err, "did you mean camera"));
    CHECK(has(swarm.hivectl({"start", "nothing-like-it"}).err, "face"));
}

TEST_CASE("start: a drone that dies at its start is reported with its exit code and its reason")
{
    const Swarm swarm;
    const auto no_file = swarm.hivectl({"start", "camera", "source=/nowhere/at/all.mp4"});
    CHECK(no_file.exit_code != 0);
    CHECK(has(no_file.err, "exit code 1"));
    CHECK(has(no_file.err, "/nowhere/at/all.mp4"));
    const auto no_parameter = swarm.hivectl({"start", "camera", "fsp=30"});
    CHECK(no_parameter.exit_code != 0);
    CHECK(has(no_parameter.err, "fps"));
    CHECK(Json::parse(swarm.hivectl_done({"ps", "--json"})).empty());
}

TEST_CASE("limits: a file or a value that no drone would take is refused here, and the drone goes on")
{
    const Swarm swarm;
    const auto face = swarm.drone("face", "face");
    const auto large = swarm.home() / "large";
    std::ofstream(large).put('x');
    std::filesystem::resize_file(large, 70'000'000);
    const auto put = swarm.hivectl({"put", "face.image", large.string(), "--type", "image/jpeg"});
    CHECK(put.exit_code == 5);
    CHECK(put.err.find("a body of 70000000 bytes, limit 67108864") != std::string::npos);
    CHECK(has(swarm.hivectl({"put", "face.image", large.string()}).err, "unknown media type of " + large.string()));
    const auto missing = swarm.hivectl({"put", "face.image", (swarm.home() / "missing").string()});
    CHECK(missing.exit_code == 1);
    CHECK(has(missing.err, "missing: No such file or directory"));
    const auto set = swarm.hivectl({"set", "face", "cascade=" + std::string(20'000, 'x')});
    CHECK(set.exit_code == 5);
    CHECK(set.err.find("a string of over 16384 bytes") != std::string::npos);
    CHECK(swarm.hivectl_done({"ps"}).find("face") != std::string::npos);
}

TEST_CASE("hung: a drone that was stopped by SIGSTOP is shown as silent, costs a command no longer than its timeout, "
          "and goes on")
{
    const Swarm swarm;
    const auto drone = swarm.drone("ticker", "hung"), other = swarm.drone("ticker", "other");
    drone.signal(SIGSTOP);
    const auto fastest = [&](const std::vector<std::string>& words) {
        auto best = swarm.hivectl(words);
        for (int i = 0; i < 2 && best.took >= stated(4000ms); ++i)
            best = swarm.hivectl(words);
        CHECK(best.took < stated(4000ms));  // the default timeout is 5 s
        return best;
    };
    const auto ps = fastest({"ps", "--json"});
    CHECK(ps.exit_code == 0);
    CHECK(Json::parse(ps.out).at(0).at("state") == "silent");
    CHECK(Json::parse(swarm.hivectl_done({"ps", "other", "--json", "--timeout", "10"})).at(0).at("state") == "idle");
    CHECK(fastest({"get", "hung", "--timeout", "0.5"}).exit_code == 124);
    for (const auto& words : {std::vector<std::string>{"get", "hung"}, {"connect", "hung", "other"}}) {
        const auto advised = fastest(words);  // more time would not help
        CHECK_MESSAGE(advised.err.ends_with("no hello within 2 s; see why it does not answer: hivectl explain\n"),
                      advised.err);
    }
    CHECK(swarm.hivectl({"explain"}).out.find("the process of hung is suspended") != std::string::npos);
    drone.signal(SIGCONT);
    CHECK(swarm.hivectl({"get", "hung"}).exit_code == 0);
}

TEST_CASE(
    "log: the file of a drone started by hivectl is bounded, what it held is kept once, and a file of another name "
    "is left alone")
{
    constexpr std::uintmax_t full = 4 * 1024 * 1024;
    const Swarm swarm;
    const auto log = swarm.home() / "ticker.log", before = swarm.home() / "ticker.log.1";
    const auto fill = [](const std::filesystem::path& file) {
        std::ofstream(file, std::ios::binary) << "first words\n" << std::string(full - 20, 'x') << "\n";
    };
    fill(log);
    swarm.hivectl_done({"start", "ticker"});
    CHECK(std::filesystem::file_size(log) < 4096);
    CHECK(swarm.log("ticker").find("ticker: started") != std::string::npos);
    CHECK(std::filesystem::file_size(before) >= full - 20);
    CHECK(std::filesystem::file_size(before) <= full);
    swarm.hivectl_done({"stop", "ticker"});

    fill(log);
    std::ofstream(swarm.home() / "ticker.state") << R"({"kind": "camera"})";  // which it mentions, and so cuts its log
    const auto refused = swarm.hivectl({"start", "ticker", "fps=no"});        // the rest still has its last lines
    CHECK(refused.exit_code != 0);
    CHECK(std::filesystem::file_size(log) < 4096);
    CHECK(refused.err.find("fps") != std::string::npos);

    const auto other = swarm.home() / "my.log";
    fill(other);
    const auto command = swarm.program("hive-ticker").string() + " --name ticker 2>>" + other.string() + " & wait $!";
    const Process process({"/bin/sh", "-c", command}, {"HIVE_HOME=" + swarm.home().string()}, swarm.home() / "sh.log");
    REQUIRE(eventually([&] { return swarm.hivectl({"ps", "ticker"}).exit_code == 0; }));
    CHECK(std::filesystem::file_size(other) >= full - 20);
    swarm.hivectl_done({"stop", "ticker"});
}

TEST_CASE("logs: the last lines of a drone, also of one that has crashed")
{
    const Swarm swarm;
    swarm.hivectl_done({"start", "ticker"});
    CHECK(has(swarm.hivectl_done({"logs", "ticker"}), "started"));
    CHECK(lines_of(swarm.hivectl_done({"logs", "ticker", "-n", "1", "--json"})) == 1);
    ::kill(static_cast<pid_t>(swarm.application().status("ticker").pid), SIGKILL);
    CHECK(has(swarm.hivectl_done({"logs", "ticker"}), "started"));
    std::ofstream(swarm.home() / "ticker.log", std::ios::app) << "last words";
    CHECK(swarm.hivectl_done({"logs", "ticker", "-n", "1"}) == "last words\n");
    CHECK(swarm.hivectl({"logs", "nobody"}).exit_code == 3);
}
