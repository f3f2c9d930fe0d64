// Compares the predictions of hivectl advise with the effects of its commands.
#include "bad_link.hpp"
#include "measure.hpp"
#include "status_sums.hpp"

#include <possible.hpp>

#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <thread>

#include <sched.h>
#include <unistd.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// Runs hivectl with arguments, and returns its output.
using Shell = std::function<std::string(const std::string& line)>;

struct Came {
    double per_s = 0, age_us = 0;
};

/// Predicted and measured values of each case.
class Judge {
public:
    /// @param results  outputs of sleepers, which report the age of their input after its processing
    Came measured(hive::Application& application, const std::vector<std::string>& drones) const
    {
        std::vector<hive::Endpoint> ends;
        for (const auto& drone : drones)
            ends.push_back({drone, "result"});
        const auto collector = application.collect(ends);
        std::map<std::string, std::vector<Clock::time_point>> times;
        double ages = 0, events = 0;
        for (const auto end = Clock::now() + 1200ms; Clock::now() < end;)
            if (const auto event = collector->next(20ms)) {
                times[event->sender].push_back(event->received);
                ages += event->header.at("age_us").get<double>();
                ++events;
            }
        Came came{.age_us = ages / events};
        for (const auto& [drone, moments] : times)
            came.per_s += rate_of(moments);
        return came;
    }

    /// Gets the proposal, executes it, and measures again.
    /// @param after  the drones whose results count then
    void judge(const std::string& name, hive::Application& application, const Shell& shell,
               const std::vector<std::string>& before, const std::vector<std::string>& after, const std::string& what,
               const std::string& goal = "fps")
    {
        judge(
            name, shell, before.front(), [&] { return measured(application, after); }, what, goal);
    }
    void judge(const std::string& name, const Shell& shell, const std::string& drone,
               const std::function<Came()>& measured_after, const std::string& what, const std::string& goal = "fps")
    {
        const bool fps = goal == "fps";
        const auto line =
            Json::parse(shell("hivectl advise " + drone + " --json --time 1.5 --goal " + goal)).at("lines").at(0);
        const auto& proposals = line.at("proposals");
        const auto proposal =
            std::ranges::find(proposals, Json(what), [](const Json& each) { return each.at("what"); });
        REQUIRE_MESSAGE(proposal != proposals.end(), name, ": ", line.dump(2));
        shell(proposal->at("command").get<std::string>());
        std::this_thread::sleep_for(1s);  // until earlier events have passed
        const auto came = measured_after();
        const double predicted = proposal->at(fps ? "predicted_per_s" : "predicted_us").get<double>();
        const double was = line.at(fps ? "per_s" : "latency_us").get<double>(), is = fps ? came.per_s : came.age_us;
        const double error = std::abs(is / predicted - 1);
        ++cases_;
        good_ += error <= 0.1 ? 1 : 0;
        CHECK_MESSAGE((fps ? is >= 0.97 * was : is <= 1.03 * was), name, ": ", line.dump(2));
        MESSAGE(name << ": " << std::string(fps ? "per second" : "us old") << " " << was << ", predicted " << predicted
                     << " (" << proposal->at("sure").get<std::string>() << "), came " << is << ", off by "
                     << 100 * error << " %; load " << machine_load());
        if (error > 0.1)
            MESSAGE(line.dump(2));
    }
    /// Nine of ten.
    void check() const { CHECK(10 * good_ >= 9 * cases_); }

private:
    int cases_ = 0, good_ = 0;
};

Shell shell_of(const Swarm& swarm)
{
    return [&](const std::string& line) {
        const auto done = swarm.run({"/bin/sh", "-c", line});
        REQUIRE_MESSAGE(done.exit_code == 0, line, "\n", done.err);
        return done.out;
    };
}

Shell shell_of(const Machine& machine)
{
    return [&](const std::string& line) {
        const auto done = machine.swarm.run(machine.net.inside({"/bin/sh", "-c", line}));
        REQUIRE_MESSAGE(done.exit_code == 0, line, "\n", done.err);
        return done.out;
    };
}

void judge_workers(Judge& judge)
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=150"}),
               worker = swarm.drone("sleeper", "worker", {"work_ms=50"});
    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""});
    std::this_thread::sleep_for(300ms);
    std::vector<std::string> workers{"worker"};
    for (int count = 2; count <= 4; ++count) {
        const auto before = workers;
        workers.push_back("worker-" + std::to_string(count));
        judge.judge(std::to_string(count) + " workers that sleep", application, shell_of(swarm), before, workers,
                    "worker");
    }
}

/// The number of busy processors.
double processors_in_use()
{
    const auto idle = [] {
        std::ifstream file("/proc/stat");
        std::string word;
        double user = 0, nice = 0, system = 0, free = 0;
        file >> word >> user >> nice >> system >> free;
        return free / static_cast<double>(::sysconf(_SC_CLK_TCK));
    };
    const auto before = idle();
    std::this_thread::sleep_for(300ms);
    return static_cast<double>(::sysconf(_SC_NPROCESSORS_ONLN)) - (idle() - before) / 0.3;
}

/// Are the processors free of other programs?
bool quiet(const std::string& what)
{
    constexpr double few = 0.4;
    constexpr int tries = 10;  // 3 s: eventually() would wait longer on a busy machine
    for (int i = 0; i < tries; ++i)
        if (processors_in_use() < few)
            return true;
    MESSAGE(what << ": not judged, since other programs use the processors");
    return false;
}

void judge_processors(Judge& judge)
{
    if (!quiet("workers that compute"))
        return;
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=300"}),
               worker = swarm.drone("sleeper", "worker", {"burn_ms=20"});
    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""});
    std::this_thread::sleep_for(300ms);
    judge.judge("2 workers that compute", application, shell_of(swarm), {"worker"}, {"worker", "worker-2"}, "worker");
    const auto other = swarm.drone("ticker", "other", {"pace=demand"}),
               busy = swarm.drone("sleeper", "busy", {"burn_ms=10", "emits=false"});
    application.connect({"other", ""}, {"busy", ""});
    std::this_thread::sleep_for(300ms);
    judge.judge("2 workers without a busy drone", application, shell_of(swarm), {"worker", "worker-2"},
                {"worker", "worker-2"}, "halt");
}

void judge_demand(Judge& judge)
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"}),
               worker = swarm.drone("sleeper", "worker", {"work_ms=40"}),
               last = swarm.drone("sleeper", "last", {"work_ms=25"}),
               end = swarm.drone("sleeper", "end", {"emits=false"});
    auto application = swarm.application();
    application.connect({"last", ""}, {"end", ""});
    application.connect({"worker", ""}, {"last", ""});
    application.connect({"source", ""}, {"worker", ""});
    std::this_thread::sleep_for(500ms);
    judge.judge("a line on demand, and then its next limit", application, shell_of(swarm), {"end"}, {"last"}, "worker");
}

void judge_latency(Judge& judge)
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=90"}),
               worker = swarm.drone("sleeper", "worker", {"work_ms=30"});
    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""}, {.window = 4, .group = {}, .lease = {}});
    std::this_thread::sleep_for(500ms);
    judge.judge("latency: window 4 to 1", application, shell_of(swarm), {"worker"}, {"worker"}, "window", "latency");
    application.connect({"source", ""}, {"worker", ""}, {.window = 4, .group = {}, .lease = {}});
    std::this_thread::sleep_for(500ms);
    judge.judge("latency: a lower rate", application, shell_of(swarm), {"worker"}, {"worker"}, "source_rate",
                "latency");
    application.set("source", {{"fps", 90}});
    application.connect({"source", ""}, {"worker", ""},
                        {.transfer = hive::Transfer::streaming, .group = {}, .lease = {}});
    std::this_thread::sleep_for(500ms);
    const auto after_queue = [&] {
        const auto queued = [&] { return at_inputs(application.status("worker"), &hive::InputStatus::queued); };
        REQUIRE(eventually([&] { return queued() <= 1; }, 20'000ms));
        std::this_thread::sleep_for(200ms);
        return judge.measured(application, {"worker"});
    };
    judge.judge("latency: the newest event instead of each", shell_of(swarm), "worker", after_queue, "transfer",
                "latency");
}

void judge_encoding_here(Judge& judge)
{
    if (!quiet("raw instead of jpeg"))  // the speed of an encoder depends on them
        return;
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=scene:plain", "width=1280", "height=960", "fps=200"}),
               worker = swarm.drone("sleeper", "worker", {"work_ms=5"});
    auto application = swarm.application();
    hive::ConnectionOptions jpeg{.group = {}, .lease = {}};
    jpeg.encoding = "jpeg";
    application.connect({"camera", "image"}, {"worker", ""}, jpeg);
    std::this_thread::sleep_for(300ms);
    judge.judge("raw instead of jpeg on one machine", application, shell_of(swarm), {"worker"}, {"worker"}, "encoding");
}

void judge_network(Judge& judge)
{
    if (!possible(missing_for_lab()))
        return;
    const Lab lab({"cam1", "gpu1"});
    lab.share_key();
    const auto &from = lab.machine(0), &to = lab.machine(1);
    for (const char* drone : {"ticker fps=120", "camera fps=20"})
        from.hivectl_done("start " + std::string(drone) + " --listen tcp://" + from.address);
    auto at_source = from.swarm.application(), application = to.swarm.application();
    for (const char* drone : {"ticker", "camera"})
        to.hivectl_done(std::string("place add ") + drone + " " + at_source.status(drone).places.at(1));
    for (const char* drone : {"sleeper --as worker work_ms=10", "sleeper --as viewer work_ms=10"})
        to.hivectl_done(std::string("start ") + drone);
    BadLink link(from, to, {.delay = 40ms});
    for (const int window : {1, 4}) {
        to.hivectl_done("connect ticker worker --window " + std::to_string(window));
        REQUIRE(eventually([&] { return application.status("worker").inputs.at(0).round_trip_us > 70'000; }, 10'000ms));
        judge.judge("window " + std::to_string(window) + " over 80 ms", application, shell_of(to), {"worker"},
                    {"worker"}, "window");
    }
    to.hivectl_done("halt worker");
    if (!quiet("jpeg over a narrow link"))  // raw images over TLS cost processor time
        return;
    link.set({.delay = 2ms, .megabits = 40, .buffer_bytes = 1024 * 1024});
    to.hivectl_done("connect camera.image viewer --encoding raw");
    std::this_thread::sleep_for(2500ms);  // until the round trip is measured
    judge.judge("jpeg instead of raw over 40 Mbit/s", application, shell_of(to), {"viewer"}, {"viewer"}, "encoding");
}

/// Two machines of a lab get one processor each and see only that one, as containers do: their processes run on it, and
/// read its times in /proc/stat.
class OwnProcessors {
public:
    explicit OwnProcessors(std::filesystem::path directory) : directory_(std::move(directory))
    {
        std::ofstream(directory_ / "online") << "0\n";
        for (std::size_t i = 0; i < files_.size(); ++i)
            files_[i].open(file(i));
        copy();
        copying_ = std::jthread([this](const std::stop_token& ended) {
            for (; !ended.stop_requested(); std::this_thread::sleep_for(20ms))
                copy();
        });
    }
    /// Moves a shell to a processor, with all that it starts in its own mount namespace.
    [[nodiscard]] std::string enter(std::size_t processor) const
    {
        return bind(processor) + "taskset -pc " + std::to_string(processor) + " $$ > /dev/null; ";
    }
    /// The same for the processes that run in a network.
    [[nodiscard]] std::string move(const std::string& network, std::size_t processor) const
    {
        return "for pid in $(ip netns pids " + network + "); do nsenter -t $pid -m /bin/sh -ec '" + bind(processor)
               + "' && taskset -pc " + std::to_string(processor)
               + " $pid || ! kill -0 $pid 2> /dev/null; done";  // one may have exited meanwhile
    }

private:
    [[nodiscard]] std::filesystem::path file(std::size_t i) const { return directory_ / ("stat" + std::to_string(i)); }
    [[nodiscard]] std::string bind(std::size_t i) const
    {
        return "mount --bind " + file(i).string() + " /proc/stat; mount --bind " + (directory_ / "online").string()
               + " /sys/devices/system/cpu/online; ";
    }
    /// Lines of one length, so that no reader sees half of one.
    void copy()
    {
        constexpr std::size_t length = 200;
        std::ifstream now("/proc/stat");
        for (std::string line; std::getline(now, line);)
            for (std::size_t i = 0; i < files_.size(); ++i)
                if (const auto name = "cpu" + std::to_string(i) + " "; line.starts_with(name)) {
                    auto text = "cpu  " + line.substr(name.size());
                    text.resize(length, ' ');
                    files_[i].seekp(0);
                    files_[i] << text << std::endl;
                }
    }

    std::filesystem::path directory_;
    std::array<std::ofstream, 2> files_;
    std::jthread copying_;
};

/// Events per second that the receivers of a source have processed, on any machine.
Came acknowledged(hive::Application& application)
{
    const auto count = [&] {
        std::int64_t sum = 0;
        for (const auto& output : application.status("source").outputs)
            for (const auto& edge : output.edges)
                sum += edge.group ? 0 : edge.events.of(hive::Fate::acknowledged);
        return static_cast<double>(sum);
    };
    const auto begin = Clock::now();
    const auto before = count();
    std::this_thread::sleep_for(2s);
    const auto events = count() - before;
    return {.per_s = events / std::chrono::duration<double>(Clock::now() - begin).count()};
}

void judge_machine(Judge& judge)
{
    cpu_set_t allowed;
    const bool both =
        ::sched_getaffinity(0, sizeof allowed, &allowed) == 0 && CPU_ISSET(0, &allowed) && CPU_ISSET(1, &allowed);
    if (!possible(missing_for_lab()) || !possible(both ? "" : "the processors 0 and 1") || !quiet("another machine"))
        return;
    const Lab lab({"gpu1"});
    lab.share_key();
    OwnProcessors processors(lab.directory());
    const auto moved = lab.laptop().run({"/bin/sh", "-ec", processors.move(lab.machine(0).net.name(), 1)});
    REQUIRE_MESSAGE(moved.exit_code == 0, moved.err);
    const Shell shell = [&](const std::string& line) { return lab.shell_done(processors.enter(0) + line); };
    shell("hivectl start ticker --as source fps=300 --listen tcp://10.77.1.2");
    shell("hivectl start sleeper --as worker burn_ms=20");
    shell("hivectl start sleeper --as idle --on gpu1");
    shell("hivectl connect source worker");
    auto application = lab.laptop().application();
    std::this_thread::sleep_for(300ms);
    judge.judge(
        "a worker on another machine", shell, "worker", [&] { return acknowledged(application); }, "machine");
}

}  // namespace

TEST_CASE("advised: what is predicted comes within 10 % in nine of ten cases, and nothing is worse than before")
{
    if (!possible(missing_if_sanitized()))
        return;  // a measurement
    Judge judge;
    judge_workers(judge);
    judge_processors(judge);
    judge_demand(judge);
    judge_latency(judge);
    judge_encoding_here(judge);
    judge_network(judge);
    judge_machine(judge);
    judge.check();
}
