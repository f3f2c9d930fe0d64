// The commands of README's "Several machines" between machines: network namespaces, each with an sshd of its own. Root
// is needed, and iproute2 and openssh-server; where that is not to be had, the tests say so and end.
#include "delay_relay.hpp"
#include "measure.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <unistd.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

namespace fs = std::filesystem;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Json row_named(const std::string& rows, const std::string& name)
{
    for (const auto& row : Json::parse(rows))
        if (row.at("name") == name)
            return row;
    return nullptr;
}

/// A network namespace, gone at the end.
class Namespace {
public:
    Namespace(const Swarm& swarm, std::string name) : swarm_(swarm), name_(std::move(name))
    {
        made_ = swarm_.run({"/usr/bin/env", "ip", "netns", "add", name_}).exit_code == 0;
    }
    ~Namespace()
    {
        if (made_)
            static_cast<void>(swarm_.run({"/usr/bin/env", "ip", "netns", "delete", name_}));
    }
    Namespace(const Namespace&) = delete;
    Namespace& operator=(const Namespace&) = delete;

    [[nodiscard]] bool made() const { return made_; }
    [[nodiscard]] const std::string& name() const { return name_; }
    /// The words of a command that is run inside.
    [[nodiscard]] std::vector<std::string> inside(const std::vector<std::string>& words) const
    {
        std::vector<std::string> all{"/usr/bin/env", "ip", "netns", "exec", name_};
        all.insert(all.end(), words.begin(), words.end());
        return all;
    }
    void run(const std::string& commands) const
    {
        const auto done = swarm_.run(inside({"/bin/sh", "-ec", commands}));
        REQUIRE_MESSAGE(done.exit_code == 0, commands, ": ", done.err);
    }

private:
    const Swarm& swarm_;
    std::string name_;
    bool made_ = false;
};

/// A machine with a home of its own and an address that the others reach.
struct Machine {
    Machine(const Namespace& hub, const std::string& name, int number)
        : net(swarm, hub.name() + "-" + name), address("10.77." + std::to_string(number) + ".2")
    {
        const std::string link = "h" + std::to_string(number), ends = "10.77." + std::to_string(number);
        hub.run("ip link add " + link + " type veth peer name uplink netns " + net.name() + "; ip address add " + ends
                + ".1/24 dev " + link + "; ip link set " + link + " up");
        net.run("ip link set lo up; ip address add " + address
                + "/24 dev uplink; ip link set uplink up; ip route add default via " + ends + ".1");
    }

    Swarm swarm;
    Namespace net;
    std::string address;
};

/// What this machine cannot do, or nothing.
std::string missing()
{
    if (::getuid() != 0)
        return "root";
    if (!fs::exists("/usr/sbin/sshd"))
        return "openssh-server";
    const Swarm swarm;
    const Namespace trial(swarm, "hv-try-" + std::to_string(::getpid()));
    const std::string links = "ip link add h1 type veth peer name h2 && echo 1 > /proc/sys/net/ipv4/ip_forward";
    const bool possible = trial.made() && swarm.run(trial.inside({"/bin/sh", "-c", links})).exit_code == 0;
    return possible ? "" : "iproute2, and the right to make network namespaces that forward packets";
}

/// A laptop, and machines that it reaches through ssh by their names.
class Lab {
public:
    explicit Lab(const std::vector<std::string>& names) : hub_(laptop_home_, "hv-" + std::to_string(::getpid()))
    {
        hub_.run("ip link set lo up; echo 1 > /proc/sys/net/ipv4/ip_forward");
        laptop_ = std::make_unique<Machine>(hub_, "laptop", 1);
        run("mkdir -p keys bin /run/sshd; for k in host user; do ssh-keygen -q -t ed25519 -N '' -f keys/$k; done");
        for (const auto& name : names)
            add(name);
        write_ssh();
    }

    /// hivectl on the laptop.
    [[nodiscard]] Finished hivectl(const std::string& words) const
    {
        return laptop_->swarm.run(on_laptop(words), 60'000ms);
    }
    std::string hivectl_done(const std::string& words) const
    {
        const auto done = hivectl(words);
        REQUIRE_MESSAGE(done.exit_code == 0, words, ": ", done.out, done.err);
        return done.out;
    }
    /// hivectl on the laptop, beside the test: what it prints goes to NAME.log in directory().
    [[nodiscard]] Process hivectl_running(const std::string& words, const std::string& name) const
    {
        return {on_laptop(words), {"HIVE_HOME=" + laptop_->swarm.home().string()}, directory() / (name + ".log")};
    }
    /// Takes a machine off the network, and puts it back.
    void cut(std::size_t machine) const { hub_.run("ip link set h" + std::to_string(machine + 2) + " down"); }
    void mend(std::size_t machine) const { hub_.run("ip link set h" + std::to_string(machine + 2) + " up"); }
    /// The namespace in the middle, to which all are linked.
    [[nodiscard]] const std::string& hub() const { return hub_.name(); }
    [[nodiscard]] const Machine& machine(std::size_t index) const { return *machines_.at(index); }
    [[nodiscard]] fs::path directory() const { return laptop_home_.home(); }

private:
    [[nodiscard]] std::vector<std::string> on_laptop(const std::string& words) const
    {
        const auto path =
            (directory() / "bin").string() + ":" + laptop_->swarm.program("hivectl").parent_path().string();
        return laptop_->net.inside({"/bin/sh", "-c", "PATH=" + path + ":$PATH; exec hivectl " + words});
    }
    void run(const std::string& commands) const
    {
        const auto done = laptop_home_.run({"/bin/sh", "-ec", "cd " + directory().string() + "; " + commands});
        REQUIRE_MESSAGE(done.exit_code == 0, commands, ": ", done.err);
    }
    void add(const std::string& name)
    {
        auto& machine =
            *machines_.emplace_back(std::make_unique<Machine>(hub_, name, static_cast<int>(machines_.size()) + 2));
        const auto file = (directory() / (name + ".conf")).string();
        const auto programs = machine.swarm.program("hivectl").parent_path().string();
        std::ofstream(file)
            << "HostKey " << directory().string() << "/keys/host\nAuthorizedKeysFile " << directory().string()
            << "/keys/user.pub\nStrictModes no\nPermitRootLogin yes\nUsePAM no\nPidFile none\nSetEnv HIVE_HOME="
            << machine.swarm.home().string() << " PATH=" << programs << ":/usr/bin:/bin\n";
        sshd_.emplace_back(machine.net.inside({"/usr/sbin/sshd", "-D", "-e", "-f", file}), std::vector<std::string>{},
                           directory() / (name + ".sshd.log"));
        config_ += "Host " + name + "\n  HostName " + machine.address + "\n";
        known_ += machine.address + " " + text_of(directory() / "keys/host.pub");
    }
    /// ssh as its user has set it up, without the files of the real user.
    void write_ssh() const
    {
        const auto here = directory().string();
        std::ofstream(directory() / "known") << known_;
        std::ofstream(directory() / "config") << config_ << "Host *\n  User root\n  IdentityFile " << here
                                              << "/keys/user\n  IdentitiesOnly yes\n  UserKnownHostsFile " << here
                                              << "/known\n  StrictHostKeyChecking yes\n";
        std::ofstream(directory() / "bin/ssh") << "#!/bin/sh\nexec /usr/bin/ssh -F " << here << "/config \"$@\"\n";
        fs::permissions(directory() / "bin/ssh", fs::perms::owner_all);
    }

    Swarm laptop_home_;
    Namespace hub_;
    std::unique_ptr<Machine> laptop_;
    std::vector<std::unique_ptr<Machine>> machines_;
    std::vector<Process> sshd_;
    std::string config_, known_;
};

bool possible()
{
    const auto what = missing();
    if (!what.empty())
        MESSAGE("left out: it needs " << what);
    return what.empty();
}

}  // namespace

TEST_CASE("machines: a camera and two workers on three machines, wired and collected from a fourth")
{
    if (!possible())
        return;
    const Lab lab({"cam1", "gpu1", "gpu2"});
    lab.hivectl_done("start camera --on cam1 --insecure fps=20");
    lab.hivectl_done("start face --on gpu1 --insecure --as face-1");
    lab.hivectl_done("start face --on gpu2 --insecure --as face-2");
    lab.hivectl_done("connect camera face-1 face-2 --share");
    const auto ps = lab.hivectl_done("ps --json");
    CHECK(row_named(ps, "camera").at("host") == "cam1");
    CHECK(row_named(ps, "face-2").at("host") == "gpu2");
    std::istringstream results(lab.hivectl_done("results 'face-*' --ordered -n 6"));
    std::int64_t last = 0;
    for (std::string line; std::getline(results, line);) {
        const auto seq = Json::parse(line).at("seq").get<std::int64_t>();
        CHECK(seq > last);
        last = seq;
    }
    CHECK(last > 0);
    for (const auto& edge : Json::parse(lab.hivectl_done("edges --json"))) {
        if (edge.at("kind") != "member")
            continue;
        CHECK(edge.at("encoding") == "jpeg");
        CHECK(edge.at("round_trip_us").get<std::int64_t>() > 0);
        // One clock for all namespaces: what is measured is the error.
        CHECK(std::abs(edge.at("clock_offset_us").get<std::int64_t>()) < 100'000);
    }
    CHECK(has(lab.hivectl_done("logs face-1"), "listening at tcp://"));
    lab.hivectl_done("stop --all");
    CHECK(lab.hivectl_done("ps --json") == "[]\n");
}

TEST_CASE("machines: a drone that is killed is unreachable, and is where it was when its machine starts it again")
{
    if (!possible())
        return;
    const Lab lab({"cam1", "gpu1"});
    lab.hivectl_done("start ticker --on cam1 --insecure fps=100");
    lab.hivectl_done("start sleeper --on gpu1 --insecure");
    lab.hivectl_done("connect ticker sleeper");
    const auto& cam1 = lab.machine(0);
    ::kill(row_named(lab.hivectl_done("ps --json"), "ticker").at("pid").get<pid_t>(), SIGKILL);
    REQUIRE(eventually([&] { return cam1.swarm.application().drones().empty(); }));
    CHECK(row_named(lab.hivectl_done("ps --json"), "ticker").at("state") == "unreachable");
    const auto again = cam1.swarm.run(cam1.net.inside({cam1.swarm.program("hivectl").string(), "start", "ticker"}));
    REQUIRE_MESSAGE(again.exit_code == 0, again.err);
    CHECK(lab.hivectl_done("get ticker fps") == "100.0\n");
    const auto received = [&] {
        return Json::parse(lab.hivectl_done("edges sleeper --json")).at(0).value("received", Json()).is_number();
    };
    CHECK(eventually(received, 10'000ms));
    CHECK(has(lab.hivectl_done("results sleeper -n 1"), "\"seq\""));
}

TEST_CASE("machines: a long way is measured, and a larger window lets more through, as edges advises")
{
    if (!possible())
        return;
    const Lab lab({"cam1", "gpu1"});
    lab.hivectl_done("start ticker --on cam1 --insecure fps=200");
    lab.hivectl_done("start sleeper --on gpu1 --insecure");
    // Far away is where the hub has it: 50 ms there and 50 ms back.
    const DelayRelay relay(lab.hub(), {"10.77.2.1", 7700}, {lab.machine(0).address, 7700}, 50ms);
    lab.hivectl_done("place remove ticker");
    lab.hivectl_done("place add ticker tcp://10.77.2.1:7700");
    const auto& gpu1 = lab.machine(1);
    auto application = gpu1.swarm.application();
    const auto input = [&] { return application.status("sleeper").inputs.at(0); };
    lab.hivectl_done("connect ticker sleeper");
    REQUIRE(eventually([&] { return input().round_trip_us > 0 && input().received > 5; }, 10'000ms));
    CHECK(input().round_trip_us >= 100'000);
    CHECK(input().options.window == 1);
    const auto edges = lab.hivectl("edges");
    CHECK_MESSAGE(has(edges.err, "hivectl connect ticker.tick sleeper.image --window "), edges.err);
    const auto rate = [&] {
        const auto before = input().received;
        const auto begin = Clock::now();
        REQUIRE(eventually([&] { return input().received >= before + 10; }, 10'000ms));
        return 10.0 / std::chrono::duration<double>(Clock::now() - begin).count();
    };
    const auto narrow = rate();
    CHECK(narrow < 11);
    lab.hivectl_done("connect ticker sleeper --window 16");
    CHECK(rate() > 2 * narrow);
}

TEST_CASE(
    "machines: a partition is noticed and mended in time, and of a source on demand nothing is lost or comes twice")
{
    if (!possible())
        return;
    const char* many = std::getenv("HIVE_TEST_PARTITIONS");
    const int partitions = many ? std::atoi(many) : 1;
    const std::int64_t events = 200 + 100 * partitions;
    const Lab lab({"cam1", "gpu1"});
    lab.hivectl_done("start ticker --on cam1 --insecure pace=demand count=" + std::to_string(events));
    lab.hivectl_done("start sleeper --on gpu1 --insecure work_ms=10");
    auto application = lab.machine(1).swarm.application();
    auto results = lab.hivectl_running("results sleeper -n " + std::to_string(events) + " --timeout 30", "results");
    REQUIRE(eventually([&] { return !application.status("sleeper").outputs.at(0).edges.empty(); }));
    lab.hivectl_done("connect ticker sleeper");
    const auto input = [&] { return application.status("sleeper").inputs.at(0); };

    for (int i = 0; i < partitions; ++i) {
        const auto before = input().received;
        REQUIRE(eventually([&] { return input().received >= before + 10; }));
        lab.cut(0);
        const auto cut = Clock::now();
        REQUIRE(eventually([&] { return !input().connected; }, 5000ms));
        const auto noticed = Clock::now() - cut;
        lab.mend(0);
        const auto mended = Clock::now();
        REQUIRE(eventually([&] { return input().connected; }, 5000ms));
        const auto back = Clock::now() - mended;
        CHECK_MESSAGE(noticed < patient(2500ms), std::chrono::duration<double>(noticed).count());
        CHECK_MESSAGE(back < patient(1500ms), std::chrono::duration<double>(back).count());
    }
    CHECK(results.wait(patient(40'000ms)) == 0);
    std::istringstream lines(text_of(lab.directory() / "results.log"));
    std::vector<std::int64_t> indices;
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with('{'))
            indices.push_back(Json::parse(line).at("header").at("index").get<std::int64_t>());
    CHECK(static_cast<std::int64_t>(indices.size()) == events);
    CHECK(std::ranges::adjacent_find(indices, std::greater_equal()) == indices.end());
}
