// A new process takes over from a drone while the swarm runs: a source on demand loses and repeats nothing.
#include "measure.hpp"
#include "successors.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <random>
#include <set>
#include <thread>

#include <signal.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;
namespace fs = std::filesystem;

namespace {

constexpr auto long_timeout = 60'000ms;  // for a replacement on a busy machine

constexpr int times = sanitized() ? 8 : 50;

/// The settings of a line of drones.
struct Parts {
    std::string source = "ticker", output = "tick", worker = "sleeper", setting = "work_ms=3", result = "result";
    std::vector<std::string> source_settings = {"pace=demand"};
    std::vector<std::string> environment{};  ///< of the source
    bool share = false;
    int window = 1;
    hive::Transfer transfer = hive::Transfer::synchronized;
};

/// A source on demand, workers that can share it, and an ordered collector. The workers run in the background: their
/// successors are not children of the test.
class Line {
public:
    explicit Line(const std::vector<std::string>& workers, const Parts& parts = {})
        : source_(swarm_.drone(parts.source, "source", parts.source_settings, {}, parts.environment))
    {
        std::vector<hive::Endpoint> results;
        for (const auto& worker : workers) {
            swarm_.hivectl_done({"start", parts.worker, "--as", worker, parts.setting}, long_timeout);
            results.push_back({worker, parts.result});
        }
        collector_ = application_.collect(results, {.ordered = parts.share});
        hive::ConnectionOptions options;
        options.group = parts.share ? "workers" : "";
        options.window = parts.window;
        options.transfer = parts.transfer;
        for (const auto& worker : workers)
            application_.connect({"source", parts.output}, {worker, "image"}, options);
        take(3);
    }

    Swarm& swarm() { return swarm_; }
    hive::Application& application() { return application_; }
    std::int64_t pid(const std::string& worker) { return application_.status(worker).pid; }

    /// Checks that the next results are consecutive.
    void take(int results)
    {
        for (int i = 0; i < results; ++i) {
            const auto event = collector_->next(patient(long_timeout));
            REQUIRE_MESSAGE(event, "no result came after ", last_);
            REQUIRE(event->identity.sequence == last_ + 1);
            ++last_;
        }
    }
    /// Takes results until the process has exited; returns its exit code.
    int take_until_ended(Process& process)
    {
        const auto end = Clock::now() + patient(long_timeout);
        for (;;) {
            if (const auto event = collector_->next(5ms)) {
                REQUIRE(event->identity.sequence == last_ + 1);
                ++last_;
            }
            if (const auto code = process.wait(0ms))
                return *code;
            REQUIRE(Clock::now() < end);
        }
    }
    /// Replaces it while it takes results.
    void replace(const std::string& worker)
    {
        auto command = swarm_.hivectl_running({"replace", worker}, "replace");
        const int code = take_until_ended(command);
        REQUIRE_MESSAGE(code == 0, swarm_.log("replace"), swarm_.log(worker));
    }
    [[nodiscard]] std::int64_t taken() const { return last_; }
    hive::Collector& collector() { return *collector_; }

private:
    Swarm swarm_;
    Process source_;
    hive::Application application_{swarm_.application()};
    std::unique_ptr<hive::Collector> collector_;
    std::int64_t last_ = 0;
};

/// The files of a drone in the home, such as its socket.
std::set<std::string> files_of(const Swarm& swarm, const std::string& drone)
{
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(swarm.home()))
        if (const auto name = entry.path().filename().string(); name.starts_with(drone + "."))
            names.insert(name);
    names.insert(drone + ".next");  // a lock file, which stays
    return names;
}

/// One process, one address, one connection to each side, and no further file of the worker.
void check_one_is_left(Line& line, const std::set<std::string>& files)
{
    const auto& swarm = line.swarm();
    line.take(10);
    CHECK(eventually([&] { return processes_of(swarm, "worker").size() == 1; }));
    CHECK(processes_of(swarm, "worker").front() == line.pid("worker"));
    CHECK(files_of(swarm, "worker") == files);
    CHECK(Json::parse(swarm.hivectl_done({"ps", "--json"})).size() == 2);
    const auto edges = [&](const char* drone) { return line.application().status(drone).outputs.at(0).edges; };
    CHECK(eventually([&] { return edges("source").size() == 1 && edges("source").at(0).connected; }));
    CHECK(eventually([&] { return edges("worker").size() == 1 && edges("worker").at(0).connected; }));
    CHECK(line.application().status("worker").inputs.size() == 1);
}

/// A program hive-KIND as a shell script. It prints the given description, and otherwise runs `body`.
void write_program(const fs::path& folder, const std::string& kind, const std::string& interface,
                   const std::string& body)
{
    fs::create_directories(folder);
    const auto file = folder / ("hive-" + kind);
    std::ofstream(file) << "#!/bin/sh\nif [ \"$1\" = --describe ]; then cat <<'END'\n"
                        << interface << "\nEND\nexit 0; fi\n"
                        << body << "\n";
    fs::permissions(file, fs::perms::owner_all);
}

std::string interface_text(const std::string& input, const std::string& type, const std::string& output)
{
    return R"({"kind": "other", "inputs": [{"name": ")" + input + R"(", "type": ")" + type
           + R"("}], "outputs": [{"name": ")" + output
           + R"(", "type": "application/json"}], "parameters": [{"name": "work_ms", "type": "integer", "default": 0, )"
           + R"("min": 0, "max": 2}]})";
}

/// With the folder of further programs.
Finished replace_with(const Swarm& swarm, const fs::path& folder, const std::vector<std::string>& words)
{
    std::vector<std::string> all{"/usr/bin/env", "HIVE_DRONE_PATH=" + folder.string(),
                                 swarm.program("hivectl").string(), "replace"};
    all.insert(all.end(), words.begin(), words.end());
    return swarm.run(all, long_timeout);
}

}  // namespace

TEST_CASE("replace: many times in a row workers of a group, with exactly all results in order")
{
    Line line({"worker-1", "worker-2", "worker-3"}, {.share = true});
    for (int i = 1; i <= times; ++i)
        line.replace("worker-" + std::to_string(i % 3 + 1));
    line.take(20);
    MESSAGE(line.taken(), " results");
}

TEST_CASE("replace: many times in a row the only worker, with exactly all results in order")
{
    Line line({"only"});
    std::set<std::int64_t> pids;
    for (int i = 1; i <= times; ++i) {
        line.replace("only");
        pids.insert(line.pid("only"));
    }
    line.take(20);
    CHECK(pids.size() == times);
    MESSAGE(line.taken(), " results");
}

TEST_CASE("replace: a camera on demand and its only face finder")
{
    Line line({"face"}, {.source = "camera",
                         .output = "image",
                         .worker = "face",
                         .setting = "scale=1.3",
                         .result = "faces",
                         .source_settings = {"pace=demand", "width=320"}});
    for (int i = 1; i <= 5; ++i)
        line.replace("face");
    line.take(5);
}

TEST_CASE("replace: without places, events are lost")
{
    Line line({"only"}, {.environment = {"HIVE_TEST_WITHOUT=places"}});
    std::int64_t last = line.taken();
    bool lost = false;
    for (int i = 1; i <= 1000 && !lost; ++i) {  // about one in twenty kills an event in flight
        auto command = line.swarm().hivectl_running({"replace", "only"}, "replace");
        while (!command.wait(0ms))
            if (const auto event = line.collector().next(5ms))
                lost = std::exchange(last, event->identity.sequence) + 1 != event->identity.sequence || lost;
    }
    CHECK(lost);
}

TEST_CASE("replace: parameters, connections and a halt pass over")
{
    Line line({"worker"});
    line.swarm().hivectl_done({"set", "worker", "work_ms=7"});
    line.swarm().hivectl_done({"halt", "worker"});
    const auto before = line.pid("worker");
    const auto row =
        hive::parse_json(line.swarm().hivectl_done({"replace", "worker", "throw_at=0", "--json"}, long_timeout));
    CHECK(row.at("before") == before);
    CHECK(row.at("pid") == line.pid("worker"));
    CHECK(line.pid("worker") != before);
    CHECK(line.application().get("worker", {"work_ms"}).at("work_ms") == 7);
    CHECK(line.application().status("worker").state == hive::State::halted);
    line.swarm().hivectl_done({"resume", "worker"});
    line.take(10);
}

TEST_CASE("replace: the old one finishes a callback of 2.4 s, longer than one that is stopped")
{
    Line line({"worker"});
    line.application().set("worker", {{"work_ms", 2400}});
    REQUIRE(eventually([&] { return line.application().status("worker").busy_for_us > 0; }));
    line.swarm().hivectl_done({"replace", "worker", "work_ms=1"}, long_timeout);
    line.take(10);
    const auto edges = line.application().status("source").outputs.at(0).edges;
    CHECK(edges.at(0).events.of(hive::Fate::lost_killed) == 0);
}

TEST_CASE("replace: when the new one is killed after the old one was asked, another one takes its place")
{
    Line line({"worker"});
    line.application().set("worker", {{"work_ms", 4000}});
    auto command = line.swarm().hivectl_running({"replace", "worker", "work_ms=1"}, "replace");
    pid_t asking = 0;
    REQUIRE(eventually(
        [&] {
            asking = std::atoi(text_of(line.swarm().home() / "worker.next").c_str());
            return asking > 0;
        },
        long_timeout));
    ::kill(asking, SIGKILL);
    REQUIRE(line.take_until_ended(command) == 0);
    CHECK(line.pid("worker") != asking);
    line.take(10);
}

TEST_CASE("replace: a question that meets neither of the two processes waits for the new one")
{
    const Swarm swarm;
    const auto sleeper = swarm.drone("sleeper", "worker");
    auto application = swarm.application(30'000ms);
    std::string failure;
    std::jthread asking([&](const std::stop_token& stop) {
        try {
            while (!stop.stop_requested())
                application.get("worker");
        } catch (const hive::Error& error) {
            failure = error.what();
        }
    });
    for (int i = 0; i < 5; ++i)
        swarm.hivectl_done({"replace", "worker"}, long_timeout);
    asking.request_stop();
    asking.join();
    CHECK_MESSAGE(failure.empty(), failure);
}

TEST_CASE("replace: a drone that is told to stop meanwhile stays stopped, while the new one loads and while it waits")
{
    for (const bool loads : {true, false}) {
        Line line({"worker"});
        const auto& swarm = line.swarm();
        line.application().set("worker", {{"work_ms", 1500}, {"start_ms", loads ? 1500 : 0}});
        REQUIRE(eventually([&] { return line.application().status("worker").busy_for_us > 0; }));
        auto command = swarm.hivectl_running({"replace", "worker"}, "replace");
        REQUIRE(
            eventually([&] { return loads ? successors(swarm).size() == 1 : fs::exists(swarm.home() / "worker.next"); },
                       long_timeout));
        swarm.hivectl_done({"stop", "worker"}, long_timeout);
        CHECK(command.wait(patient(10'000ms)) != 0);
        CHECK_MESSAGE(has(swarm.log("replace"), "worker was stopped while it was being replaced"),
                      swarm.log("replace"));
        CHECK(successors(swarm).empty());
        CHECK(swarm.hivectl({"get", "worker"}).exit_code == 3);
    }
}

TEST_CASE("replace: a drone that is restarted meanwhile, and still loads, is replaced when it is ready")
{
    const Swarm swarm;
    swarm.hivectl_done({"start", "sleeper", "--as", "worker"});
    auto command = swarm.hivectl_running({"replace", "worker", "start_ms=700"}, "replace");
    REQUIRE(eventually([&] { return successors(swarm).size() == 1; }, long_timeout));
    swarm.hivectl_done({"stop", "worker"});
    swarm.hivectl_done({"start", "sleeper", "--as", "worker", "start_ms=1500", "work_ms=3"}, long_timeout);
    CHECK(command.wait(patient(10'000ms)) == 0);
    const auto values = swarm.application().get("worker");
    CHECK(values.at("work_ms") == 3);
    CHECK(values.at("start_ms") == 700);
}

TEST_CASE("replace: of two at once one waits or is refused, and one drone runs")
{
    Line line({"worker"});
    auto one = line.swarm().hivectl_running({"replace", "worker"}, "one"),
         two = line.swarm().hivectl_running({"replace", "worker"}, "two");
    const int first = line.take_until_ended(one), second = line.take_until_ended(two);
    CHECK(std::min(first, second) == 0);
    const int other = std::max(first, second);
    const auto said = line.swarm().log("one") + line.swarm().log("two");
    CHECK_MESSAGE((other == 0 || said.find("worker is being replaced already") != std::string::npos), said);
    line.take(10);
    CHECK(eventually([&] { return successors(line.swarm()).size() == 1; }));
}

TEST_CASE("replace: what does not start, or does not fit, leaves the old one as it was")
{
    Line line({"worker"});
    const auto& swarm = line.swarm();
    const auto folder = swarm.home() / "programs";
    const auto before = line.pid("worker");
    const auto refused = [&](const std::string& kind, int code, const std::string& word) {
        const auto finished = replace_with(swarm, folder, {"worker", "--kind", kind});
        CAPTURE(finished.err);
        CHECK(finished.exit_code == code);
        CHECK(finished.err.find(word) != std::string::npos);
        CHECK(line.pid("worker") == before);
        line.take(5);
    };
    line.application().set("worker", {{"work_ms", 2}});
    write_program(folder, "broken", interface_text("image", "*/*", "result"), "echo 'no model here' >&2; exit 3");
    refused("broken", 3, "no model here");
    write_program(folder, "slow", interface_text("image", "*/*", "result"), "sleep 100");
    const auto late = replace_with(swarm, folder, {"worker", "--kind", "slow", "--timeout", "0.2"});
    CHECK(late.exit_code == 124);
    write_program(folder, "deaf", interface_text("sound", "*/*", "result"), "exit 1");
    refused("deaf", 5, "no input image, which receives source.tick");
    write_program(folder, "mute", interface_text("image", "*/*", "words"), "exit 1");
    refused("mute", 5, "no output result");
    write_program(folder, "reader", interface_text("image", "text/plain", "result"), "exit 1");
    refused("reader", 6, "takes text/plain");
    line.application().set("worker", {{"work_ms", 3}});
    refused("broken", 5, "work_ms");
    CHECK(swarm.hivectl({"replace", "nobody"}).exit_code == 3);
}

TEST_CASE("replace: Ctrl-C stops a new process that is not ready, and the old one goes on")
{
    const Swarm swarm;
    swarm.hivectl_done({"start", "sleeper", "--as", "worker"});
    const auto before = swarm.application().status("worker").pid;
    auto command = swarm.hivectl_running({"replace", "worker", "start_ms=100000", "--timeout", "100"}, "replace");
    REQUIRE(eventually([&] { return successors(swarm).size() == 1; }, long_timeout));
    command.signal(SIGINT);
    CHECK(command.wait(patient(10'000ms)) == 130);
    CHECK_MESSAGE(has(swarm.log("replace"), "cancelled while the successor of worker was starting"),
                  swarm.log("replace"));
    CHECK(successors(swarm).empty());
    CHECK(swarm.application().status("worker").pid == before);
}

TEST_CASE("replace: the new one has the options of the old one, and an up finds nothing to do")
{
    const Swarm swarm;
    const auto file = swarm.home() / "one.json";
    std::ofstream(file) << R"({"swarm": "one", "drones": {"worker": {"kind": "sleeper", "log_level": "debug",)"
                           R"( "remote_operator": true, "set": {"work_ms": 3}}}})";
    swarm.hivectl_done({"up", file.string()});
    const auto before = swarm.application().status("worker").pid;
    swarm.hivectl_done({"replace", "worker"}, long_timeout);
    CHECK(swarm.application().status("worker").pid != before);
    CHECK(swarm.hivectl_done({"up", file.string()}).empty());
    swarm.hivectl_done({"replace", "worker", "--log-level", "info"}, long_timeout);
    CHECK(has(swarm.hivectl_done({"up", file.string(), "--dry-run"}), "restart worker log_level=debug"));
}

TEST_CASE("replace: a drone that keeps state needs a word more")
{
    const Swarm swarm;
    swarm.hivectl_done({"start", "counter"});
    const auto refused = swarm.hivectl({"replace", "counter"});
    CHECK(refused.exit_code == 5);
    CHECK(refused.err.find("--lose-state") != std::string::npos);
    swarm.hivectl_done({"replace", "counter", "--lose-state"}, long_timeout);
}

TEST_CASE("replace: a drone that does not answer is killed only with --force, and its successor is as it was")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50"});
    swarm.hivectl_done({"start", "sleeper", "--as", "worker"});
    swarm.hivectl_done({"connect", "source", "worker"});
    swarm.hivectl_done({"set", "worker", "work_ms=3"});
    auto application = swarm.application();
    const auto works = [&] { return application.status("worker").inputs.at(0).processed > 0; };
    REQUIRE(eventually(works));
    const auto hanging = application.status("worker").pid;
    ::kill(static_cast<pid_t>(hanging), SIGSTOP);
    const auto refused = swarm.hivectl({"replace", "worker"}, long_timeout);
    CHECK(refused.exit_code == 124);
    CHECK_MESSAGE(has(refused.err, "hivectl replace worker --force"), refused.err);
    for (const std::string kind : {"face", "no-such-kind"}) {  // checked before it is killed
        CHECK(swarm.hivectl({"replace", "worker", "--force", "--kind", kind}, long_timeout).exit_code != 0);
        CHECK(::kill(static_cast<pid_t>(hanging), 0) == 0);
    }
    const auto forced = hive::Json::parse(swarm.hivectl_done({"replace", "worker", "--force", "--json"}, long_timeout));
    CHECK(forced.at("before") == hanging);
    CHECK(forced.at("pid") != hanging);
    CHECK(application.get("worker", {"work_ms"}).at("work_ms") == 3);
    CHECK(eventually(works));
    const auto again = hive::Json::parse(swarm.hivectl_done({"replace", "worker", "--force", "--json"}, long_timeout));
    CHECK(again.at("before") == forced.at("pid"));  // it answers, so it hands over
    CHECK(eventually([&] { return application.status("worker").pid == again.at("pid") && works(); }));
}

TEST_CASE("replace: of two with --force, at once or one second apart, no new process is killed, and nothing is left")
{
    for (const auto apart : {0ms, 1000ms}) {
        CAPTURE(apart.count());
        Line line({"worker"});
        const auto& swarm = line.swarm();
        const auto hanging = line.pid("worker");
        const auto files = files_of(swarm, "worker");
        ::kill(static_cast<pid_t>(hanging), SIGSTOP);
        const std::vector<std::string> words{"replace", "worker", "--force", "--json"};
        auto one = swarm.hivectl_running(words, "one");
        std::this_thread::sleep_for(apart);  // the first one kills while the second one waits for an answer
        auto two = swarm.hivectl_running(words, "two");
        const int first = one.wait(patient(long_timeout)).value_or(-1), second = line.take_until_ended(two);
        std::array ends{std::pair(first, swarm.log("one")), std::pair(second, swarm.log("two"))};
        const auto kills = [&](const auto& end) {
            return end.first == 0 && Json::parse(end.second).at("before") == hanging;
        };
        if (apart == 0ms && !kills(ends[0]))
            std::swap(ends[0], ends[1]);
        REQUIRE_MESSAGE(kills(ends[0]), ends[0].second);
        const auto told = Json::parse(ends[0].second);
        if (ends[1].first != 0)
            CHECK_MESSAGE((has(ends[1].second, "is being replaced already") || has(ends[1].second, "is running already")
                           || has(ends[1].second, "is not running")),
                          ends[1].second);
        else if (const auto other = Json::parse(ends[1].second); other.at("pid") != told.at("pid"))
            CHECK(other.at("before") == told.at("pid"));  // it answered, and handed over
        check_one_is_left(line, files);
    }
}

TEST_CASE("replace: --force while another replace waits for a drone that hangs: its successor has the name, and "
          "nothing is left")
{
    Line line({"worker"});
    const auto& swarm = line.swarm();
    const auto hanging = line.pid("worker");
    const auto files = files_of(swarm, "worker");
    auto waiting = swarm.hivectl_running({"replace", "worker", "start_ms=5000", "--timeout", "50", "--json"}, "one");
    REQUIRE(eventually([&] { return successors(swarm).size() == 1; }, long_timeout));
    REQUIRE(line.pid("worker") == hanging);
    REQUIRE(::kill(static_cast<pid_t>(hanging), SIGSTOP) == 0);
    REQUIRE(eventually([&] { return !text_of(swarm.home() / "worker.next").empty(); }, long_timeout));
    auto forced = swarm.hivectl_running({"replace", "worker", "work_ms=2", "--force", "--json"}, "two");
    REQUIRE_MESSAGE(line.take_until_ended(forced) == 0, swarm.log("two"));
    REQUIRE_MESSAGE(line.take_until_ended(waiting) == 0, swarm.log("one"));
    const auto one = Json::parse(swarm.log("one")), two = Json::parse(swarm.log("two"));
    CHECK(one.at("pid") == two.at("pid"));
    CHECK(two.at("before") == hanging);
    CHECK(line.application().get("worker", {"work_ms"}).at("work_ms") == 2);
    check_one_is_left(line, files);
}

TEST_CASE("replace: another kind takes over, with the connections, and is what comes back after a crash")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera");
    swarm.hivectl_done({"start", "sleeper", "--as", "worker"});
    swarm.hivectl_done({"connect", "camera.image", "worker.image"});
    swarm.hivectl_done({"replace", "worker", "--kind", "face", "scale=1.4"}, long_timeout);
    auto application = swarm.application();
    const auto works = [&] {
        const auto answer = application.status(std::vector<std::string>{"worker"}).at(0);
        const auto* status = value_of(answer.status);
        return status && status->kind == "face" && status->inputs.at(0).processed > 0;
    };
    CHECK(eventually(works, long_timeout));
    ::kill(static_cast<pid_t>(application.status("worker").pid), SIGKILL);
    REQUIRE(eventually([&] { return application.drones().size() == 1; }, long_timeout));
    swarm.hivectl_done({"start", "face", "--as", "worker"}, long_timeout);
    CHECK(eventually(works, long_timeout));
    CHECK(application.get("worker", {"scale"}).at("scale") == 1.4);
}

TEST_CASE("replace: whoever is killed in the middle, one drone of the name runs in the end, and every event gives one "
          "result")
{
    const auto seed =
        std::getenv("HIVE_TEST_SEED") ? std::stoul(std::getenv("HIVE_TEST_SEED")) : std::random_device()();
    MESSAGE("HIVE_TEST_SEED=", seed);
    std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
    const bool stream = random() % 4 == 0;
    Line line({"worker"}, {.window = stream ? 1 : static_cast<int>(random() % 4 + 1),
                           .transfer = stream ? hive::Transfer::streaming : hive::Transfer::synchronized});
    auto& application = line.application();
    for (int round = 0; round < 9; ++round) {
        std::int64_t old = 0;  // a successor may just be taking the name
        REQUIRE(eventually(
            [&] {
                const auto answer = application.status(std::vector<std::string>{"worker"}).at(0);
                old = value_or_none(answer.status).pid;
                return old != 0;
            },
            long_timeout));
        const int victim = round % 3;
        const auto due = Clock::now() + std::chrono::milliseconds(random() % 120);
        CAPTURE(seed);
        CAPTURE(round);
        auto command = line.swarm().hivectl_running({"replace", "worker"}, "replace");
        while (Clock::now() < due)
            line.take(1);
        if (victim == 0)
            command.signal(SIGKILL);
        else if (victim == 1)
            ::kill(static_cast<pid_t>(old), SIGKILL);
        const auto holder = std::atoi(text_of(line.swarm().home() / "worker.lock").c_str());
        if (victim == 2)
            for (const auto pid : successors(line.swarm()))
                if (pid != old)
                    ::kill(pid, SIGKILL);
        const int code = line.take_until_ended(command);
        // A drone killed before the start or after the end of the takeover has simply crashed.
        bool runs = false;
        REQUIRE(eventually(
            [&] {
                runs = !error_of(application.status(std::vector<std::string>{"worker"}).at(0).status);
                return runs || successors(line.swarm()).empty();
            },
            long_timeout));
        if (!runs) {
            if (victim == 2 && code != 0) {
                // The new process died with the name, before hivectl saw that it had it; or another one had taken the
                // name before, and hivectl was about to ask that.
                const auto said = line.swarm().log("replace");
                const bool another = holder != old && has(said, "cannot reach unix:");
                CHECK_MESSAGE((has(said, "was killed by signal 9") || another), said);
            } else {
                CHECK((victim == 1 ? code != 0 : code == 0));
            }
            REQUIRE(eventually([&] { return application.drones().size() == 1; }, long_timeout));  // it may be dying
            line.swarm().hivectl_done({"start", "sleeper", "--as", "worker"}, long_timeout);
        }
        line.take(10);
    }
}
