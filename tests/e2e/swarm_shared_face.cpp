// The ready-made swarm shared-face in a lab: a camera and four workers on three machines.
#include "swarm_lab.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <algorithm>
#include <csignal>
#include <set>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// The file of the repository, with machines for its drones, and a lower load, because all share the processors here.
Json shared_face()
{
    auto content = Json::parse(text_of(std::filesystem::path(HIVE_SOURCE_DIR) / "scripts/swarms/shared-face.json"));
    content["drones"]["camera"]["on"] = "cam1";
    content["drones"]["camera"]["set"]["fps"] = 8;
    content["drones"]["face"]["count"] = 4;
    content["drones"]["face"]["on"] = {"cam1", "gpu1", "gpu2"};
    content["drones"]["face"]["set"]["scale"] = 1.2;
    return content;
}

/// The duration of an `up`, and its steps.
struct Timed {
    explicit Timed(const Machines& machines, const std::string& what) : begin(Clock::now()), steps(machines.up())
    {
        const Seconds took = Clock::now() - begin;
        MESSAGE(what << ": " << took.count() << " s (load " << machine_load() << ")");
        seconds = took.count();
    }

    Clock::time_point begin;
    std::string steps;
    double seconds = 0;
};

/// Each worker finds faces in frames of the camera.
bool works(const Machines& machines)
{
    std::set<std::string> workers;
    const bool all = eventually(
        [&] {
            std::istringstream lines(machines.lab.hivectl_done("results 'face-*' -n 12 --json --timeout 20"));
            for (std::string line; std::getline(lines, line);)
                workers.insert(Json::parse(line).at("sender"));
            return workers.size() == 4;
        },
        20'000ms);
    if (!all)
        MESSAGE("some worker finds nothing:\n"
                << machines.lab.hivectl_done("ps --json --timeout 10") << machines.lab.hivectl_done("edges --json"));
    return all;
}

/// Simulates a reboot of a machine: keeps its disk, and removes processes and memory.
void reboot(const Machine& machine)
{
    std::istringstream pids(machine.swarm.run({"/usr/bin/env", "ip", "netns", "pids", machine.net.name()}).out);
    for (pid_t pid = 0; pids >> pid;) {
        const auto command = text_of("/proc/" + std::to_string(pid) + "/cmdline");
        if (!has(command, "sshd") || has(command, "@"))  // the listening one restarts at once
            ::kill(pid, SIGKILL);
    }
}

void forget_memory(const Machine& machine)
{
    const std::set<std::string> in_memory{".sock", ".lock", ".state", ".log"};
    std::vector<std::filesystem::path> lost;
    for (const auto& entry : std::filesystem::directory_iterator(machine.swarm.home()))
        if (in_memory.contains(entry.path().extension()))
            lost.push_back(entry.path());
    for (const auto& file : lost)
        std::filesystem::remove(file);
}

}  // namespace

TEST_CASE("shared-face over three machines: up, again nothing to do, and a changed scale is one set for each worker")
{
    if (!possible(missing_for_lab()))
        return;
    auto content = shared_face();
    const Machines machines(content);
    const Timed up(machines, "up of shared-face");
    CHECK(std::ranges::count(up.steps, '\n') == 5 + 4);
    CHECK(up.seconds < patient(60'000ms) / 1s);
    CHECK(works(machines));
    const auto pids = machines.pids();
    CHECK(pids.size() == 5);

    const Timed again(machines, "up again");
    const Timed once_more(machines, "up once more");
    CHECK(again.steps.empty());
    CHECK(once_more.steps.empty());
    CHECK(std::min(again.seconds, once_more.seconds) < up.seconds);
    content["drones"]["face"]["set"]["scale"] = 1.3;
    machines.write(content);
    const Timed changed(machines, "up of another scale");
    CHECK(changed.steps == "set face-1 scale=1.3\nset face-2 scale=1.3\nset face-3 scale=1.3\nset face-4 scale=1.3\n");
    CHECK(machines.up().empty());
    CHECK(machines.pids() == pids);
    CHECK(works(machines));
}

TEST_CASE("shared-face over three machines: of a mistake in the last drone nothing is left behind, and it is named")
{
    if (!possible(missing_for_lab()))
        return;
    auto content = shared_face();
    content["drones"]["zlast"] = {{"kind", "face"}, {"on", "gpu2"}, {"set", {{"cascade", "/nowhere.xml"}}}};
    const Machines machines(content);
    const auto refused = machines.lab.shell("hivectl up ~/work.json");
    CHECK(refused.exit_code == 5);
    CHECK_MESSAGE((has(refused.err, "zlast") && has(refused.err, "/nowhere.xml")), refused.err);
    CHECK(eventually([&] { return machines.processes() == 0; }));
    CHECK(machines.lab.hivectl_done("down").empty());
}

TEST_CASE("shared-face over three machines: after all of them were started anew, up of the file gives the same swarm")
{
    if (!possible(missing_for_lab()))
        return;
    const Machines machines(shared_face());
    CHECK(std::ranges::count(machines.up(), '\n') == 5 + 4);
    for (const bool memory_lost : {false, true}) {
        const auto before = machines.lab.hivectl_done("export");
        for (std::size_t i = 0; i < 3; ++i)
            reboot(machines.lab.machine(i));
        REQUIRE(eventually([&] { return machines.processes() == 0; }));
        for (std::size_t i = 0; memory_lost && i < 3; ++i)
            forget_memory(machines.lab.machine(i));
        CHECK(std::ranges::count(machines.up(), '\n') == 5 + 4);
        CHECK(machines.up().empty());
        CHECK(eventually([&] { return machines.processes() == 5; }));
        CHECK(works(machines));
        CHECK(machines.lab.hivectl_done("export") == before);
    }
}
