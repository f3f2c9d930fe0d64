// Host names across machines with a silent name server, and with a name that moves.
#include "bad_link.hpp"
#include "lab.hpp"

#include <possible.hpp>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <memory>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

/// The host names of one machine, for programs started there from now on.
class HostNames {
public:
    HostNames(const Machine& machine, const std::string& name_server) : folder_("/etc/netns/" + machine.net.name())
    {
        std::filesystem::create_directories(folder_);
        std::ofstream(folder_ / "resolv.conf") << "nameserver " << name_server << "\n";
        write("");
    }
    ~HostNames() { std::filesystem::remove_all(folder_); }
    HostNames(const HostNames&) = delete;
    HostNames& operator=(const HostNames&) = delete;

    /// Changes the same file, which running programs read.
    void write(const std::string& line) const
    {
        std::ofstream(folder_ / "hosts") << "127.0.0.1 localhost\n" << line << "\n";
    }

private:
    std::filesystem::path folder_;
};

/// A sleeper that receives from drones of another machine, by its address and by its name, with a name server that is a
/// black hole.
class Neighbours {
public:
    static constexpr int named = 6;  ///< more than there are threads that look names up
    static std::string name_of(int number) { return "named-" + std::to_string(number); }

    /// @param environment  "NAME=value", of the sleeper
    explicit Neighbours(const std::string& environment = {}) : lab_({"cam1", "gpu1", "cam2", "void"})
    {
        lab_.share_key();
        names_.write(cam1().address + " cam.test");
        here().net.run("env " + environment + " " + here().swarm.program("hivectl").string() + " start sleeper");
        connect("steady", cam1().address, 7750);
        results_ = asking_.collect({{"sleeper", "result"}});
        for (int i = 0; i < named; ++i)
            connect(name_of(i), "cam.test", 7700 + i);
        REQUIRE(eventually([&] { return input(name_of(named - 1)).connected && input("steady").received > 0; }));
    }
    /// On another machine, and known there as `host`.
    static void listen(const Machine& machine, const std::string& drone, const std::string& host, int port)
    {
        machine.hivectl_done("start ticker fps=100 --as " + drone + " --listen tcp://" + machine.address + ":"
                             + std::to_string(port) + " --advertise tcp://" + host);
    }
    void connect(const std::string& drone, const std::string& host, int port)
    {
        listen(cam1(), drone, host, port);
        here().hivectl_done("place add " + drone + " tcp://" + host + ":" + std::to_string(port));
        here().hivectl_done("connect " + drone + " sleeper");
    }
    /// Removes the name, and kills the drones that it had.
    void lose_name()
    {
        names_.write("");
        auto there = cam1().swarm.application();
        for (int i = 0; i < named; ++i)
            ::kill(static_cast<pid_t>(there.status(name_of(i)).pid), SIGKILL);
    }
    /// Moves the name to another machine, which has one of the same drones.
    void move_name()
    {
        listen(lab_.machine(2), name_of(0), "cam.test", 7700);
        names_.write(lab_.machine(2).address + " cam.test");
    }

    struct Delays {  ///< of 99 %, milliseconds
        double event, answer;
    };
    /// The intervals of the steady events, and the sleeper's response times.
    Delays watch(Seconds time)
    {
        std::vector<double> events, answers;
        auto last = Clock::now();
        for (const auto begin = last; Clock::now() - begin < time;) {
            const auto event = results_->next(1000ms);
            if (!event || event->identity.source != "steady")
                continue;
            events.push_back(1e3 * Seconds(Clock::now() - last).count());
            const auto asked = Clock::now();
            static_cast<void>(asking_.get("sleeper", {"work_ms"}));
            last = Clock::now();
            answers.push_back(1e3 * Seconds(last - asked).count());
        }
        return {most_of(std::move(events)), most_of(std::move(answers))};
    }
    /// Between two steady events, in milliseconds.
    double longest_gap(Seconds time)
    {
        double longest = 0;
        auto last = Clock::now();
        for (const auto begin = last; Clock::now() - begin < time;) {
            const auto event = results_->next(100ms);
            longest = std::max(longest, 1e3 * Seconds(Clock::now() - last).count());
            if (event && event->identity.source == "steady")
                last = Clock::now();
        }
        return longest;
    }
    [[nodiscard]] hive::InputStatus input(const std::string& drone)
    {
        for (const auto& each : asking_.status("sleeper").inputs)
            if (each.from == drone + ".tick")
                return each;
        return {};
    }
    [[nodiscard]] Finished hivectl(const std::vector<std::string>& words) const
    {
        std::vector<std::string> all{here().swarm.program("hivectl").string()};
        all.insert(all.end(), words.begin(), words.end());
        return here().swarm.run(here().net.inside(all));
    }

private:
    static double most_of(std::vector<double> values)
    {
        REQUIRE(values.size() > 10);
        std::ranges::sort(values);
        return values[values.size() * 99 / 100];
    }
    [[nodiscard]] const Machine& cam1() const { return lab_.machine(0); }
    [[nodiscard]] const Machine& here() const { return lab_.machine(1); }

    Lab lab_;
    BadLink to_name_server_{here(), lab_.machine(3), {.loss = 1}};
    HostNames names_{here(), lab_.machine(3).address};
    hive::Application asking_{here().swarm.application()};
    std::unique_ptr<hive::Collector> results_;
};

}  // namespace

TEST_CASE("network names: a name server that does not answer holds up only who asks it, and a name may move")
{
    if (!possible(missing_for_lab()))
        return;
    Neighbours neighbours;
    const auto before = neighbours.watch(3s);
    neighbours.lose_name();
    REQUIRE(eventually([&] { return !neighbours.input(Neighbours::name_of(0)).connected; }));
    const auto meanwhile = neighbours.watch(10s);
    MESSAGE("99 % of the events came within " << before.event << " ms before, " << meanwhile.event
                                              << " ms while names were looked up; of the answers within "
                                              << before.answer << " and " << meanwhile.answer << " ms");
    CHECK(meanwhile.event - before.event < 50);
    CHECK(meanwhile.answer - before.answer < 50);
    const auto error = neighbours.input(Neighbours::name_of(0)).error;
    CHECK_MESSAGE(error.find("cam.test") != std::string::npos, error);

    auto told_after = std::chrono::microseconds::max();
    for (const std::string ghost : {"ghost", "spook", "wraith"}) {
        const auto asked = neighbours.hivectl({"place", "add", ghost, "tcp://" + ghost + ".test:7700"});
        MESSAGE("an unknown name is told after " << asked.took.count() / 1000 << " ms: " << asked.err);
        CHECK(asked.exit_code != 0);
        CHECK(asked.err.find(ghost + ".test") != std::string::npos);
        told_after = std::min(told_after, asked.took);
    }
    CHECK(told_after < stated(3500ms));

    neighbours.move_name();
    const auto moved = Clock::now();
    CHECK(eventually([&] { return neighbours.input(Neighbours::name_of(0)).connected; }, 30'000ms));
    MESSAGE("the drone at its new address was found after " << Seconds(Clock::now() - moved).count() << " s");
}

TEST_CASE("network names: looked up by the thread of the network, one that is not known holds up all events")
{
    if (!possible(missing_for_lab()))
        return;
    Neighbours neighbours("HIVE_TEST_WITHOUT=lookup-threads");
    CHECK(std::min(neighbours.longest_gap(1s), neighbours.longest_gap(1s)) < 1000);
    neighbours.lose_name();
    CHECK(neighbours.longest_gap(5s) > 1000);
}
