// hivectl explain: what slows down or ends a connection between two machines, each caused for real, named and cured.
#include "bad_link.hpp"
#include "explained.hpp"

#include <possible.hpp>
#include <wall_clock.hpp>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

/// A ticker and a camera on one machine, their receivers on another.
class Two {
public:
    Two()
    {
        lab_.share_key();
        for (const auto* drone : {"ticker fps=50", "camera fps=20 width=640 height=480"})
            from().hivectl_done("start " + std::string(drone) + " --listen tcp://" + from().address);
        auto at_source = from().swarm.application();
        for (const auto* drone : {"ticker", "camera"})
            to().hivectl_done(std::string("place add ") + drone + " " + at_source.status(drone).places.at(1));
        to().hivectl_done("start sleeper --as worker");
    }
    [[nodiscard]] const Machine& from() const { return lab_.machine(0); }
    [[nodiscard]] const Machine& to() const { return lab_.machine(1); }
    [[nodiscard]] Shell shell() const { return {to().swarm, to().net.inside({})}; }

private:
    Lab lab_{{"cam1", "gpu1"}};
};

}  // namespace

TEST_CASE("explain: over a long way, a window that is too small")
{
    if (!injectable(missing_for_lab()))
        return;
    const Two two;
    const auto shell = two.shell();
    const BadLink link(two.from(), two.to(), {.delay = 40ms});
    two.to().hivectl_done("connect ticker worker");
    const auto narrow = awaited(shell, "explain worker", "small_window worker");
    CHECK(narrow.exit_code == 0);
    CHECK_MESSAGE(has(narrow.evidence(), "round trip 8"), narrow.text());  // 80 ms and more
    CHECK_MESSAGE(narrow.command().starts_with("hivectl connect ticker.tick worker.image --window "), narrow.text());
    cure(shell, narrow);
    CHECK(runs(shell, "explain worker"));
}

TEST_CASE("explain: a machine whose clock is an hour ahead")
{
    if (!injectable(missing_for_lab()) || !injectable(WallClock::missing()))
        return;
    const Two two;
    const auto shell = two.shell();
    const WallClock clock(two.from().swarm.home());
    std::string start = "env";
    for (const auto& variable : clock.environment())
        start += " " + variable;
    const auto at = "tcp://" + two.from().address + ":7790";
    two.from().net.run(start + " " + two.from().swarm.program("hivectl").string()
                       + " start ticker --as source fps=20 --listen " + at);
    two.to().hivectl_done("place add source " + at);
    two.to().hivectl_done("connect source worker");
    CHECK(runs(shell, "explain worker"));
    clock.set("+3600");
    const auto wrong = awaited(shell, "explain worker", "clock worker", 30'000ms);
    CHECK(wrong.exit_code == 0);
    CHECK_MESSAGE(has(wrong.text(), " ahead of that of this machine"), wrong.text());
    CHECK(wrong.command() == "timedatectl set-ntp true");
    clock.set("+0");  // as that command does
    CHECK(eventually([&] { return found(shell, "explain worker").runs(); }, 30'000ms));
}

TEST_CASE("explain: a slow network")
{
    if (!injectable(missing_for_lab()))
        return;
    const Two two;
    const auto shell = two.shell();
    const BadLink link(two.from(), two.to(), {.delay = 2ms, .megabits = 40, .buffer_bytes = 1024 * 1024});
    two.to().hivectl_done("connect camera worker --stream --encoding raw");
    const auto slow = awaited(shell, "explain worker", "slow_connection worker");
    CHECK(slow.exit_code == 0);
    CHECK_MESSAGE(has(slow.evidence(), " events dropped before they were sent"), slow.text());
    CHECK(slow.command() == "hivectl connect camera.image worker.image --encoding jpeg:50");
    cure(shell, slow);
    CHECK(runs(shell, "explain worker"));
}

TEST_CASE("explain: a network that is too slow for a source on demand, with a window of several images and of one")
{
    if (!injectable(missing_for_lab()))
        return;
    const Two two;
    const auto shell = two.shell();
    const BadLink link(two.from(), two.to(), {.delay = 2ms, .megabits = 2, .buffer_bytes = 1024 * 1024});
    two.from().hivectl_done("set camera pace=demand");
    two.to().hivectl_done("set worker emits=false");
    for (const std::string window : {"4", "1"}) {
        two.to().hivectl_done("connect camera worker --encoding raw --window " + window);
        const auto slow = awaited(shell, "explain worker", "slow_connection worker");
        CHECK(slow.exit_code == 9);
        CHECK_MESSAGE(has(slow.evidence(), "camera.image has sent nothing for "), slow.text());
        CHECK(slow.command() == "hivectl connect camera.image worker.image --encoding jpeg:50");
        cure(shell, slow);
        CHECK(runs(shell, "explain worker"));
    }
}

TEST_CASE("explain: a sender that was stopped on the machine where it was started over ssh")
{
    if (!injectable(missing_for_lab()))
        return;
    const Lab lab({"cam1"});
    lab.share_key();
    const Shell shell([&](const std::string& line) { return lab.shell(line); });
    lab.hivectl_done("start counter --on cam1");
    lab.hivectl_done("start ticker --as origin --on cam1");
    lab.hivectl_done("start sleeper --as worker");
    lab.hivectl_done("connect origin worker");
    CHECK(runs(shell, "explain worker"));
    lab.hivectl_done("stop origin");
    const auto at = "it ran at tcp://" + lab.machine(0).address + ":7701";
    const std::string start = "hivectl start ticker --as origin --listen tcp://0.0.0.0:7701";
    const auto stopped = awaited(shell, "explain worker", "not_running origin");
    CHECK(stopped.command() == start + " --on cam1");
    CHECK(stopped.evidence() == "worker.image receives from it; " + at);
    lab.hivectl_done("stop counter");
    const auto unknown = awaited(shell, "explain worker", "not_running origin");
    CHECK(unknown.command() == "hivectl ps");  // no drone tells how to reach the machine
    CHECK(unknown.evidence() == "worker.image receives from it; " + at + "; start it there: " + start);
    cure(shell, stopped);
    CHECK(runs(shell, "explain worker"));
}

TEST_CASE("explain: a Python file on another machine, which throws there, and which was stopped there")
{
    if (!injectable(missing_for_lab()) || !injectable(sanitized() ? "a build without sanitizers, for Python" : ""))
        return;
    const Lab lab({"cam1"});
    lab.share_key();
    const Shell shell([&](const std::string& line) { return lab.shell(line); });
    const auto file = (lab.machine(0).swarm.home() / "passes.py").string();
    const auto write = [&](const std::string& body) {
        std::ofstream(file) << "import hive\n"
                               "drone = hive.Drone('passes', 'Passes ticks on.')\n"
                               "result = drone.output('result', 'application/json', 'results')\n"
                               "@drone.on_event('in', '*/*', 'ticks')\n"
                               "def work(event):\n    "
                                   + body + "\ndrone.run()\n";
    };
    write("result.emit({'fine': True})");
    lab.hivectl_done("start counter --on cam1");  // tells how to reach the machine
    lab.hivectl_done("start ticker --as source --on cam1");
    lab.hivectl_done("start " + file + " --as origin --on cam1");
    lab.hivectl_done("start sleeper --as worker");
    lab.hivectl_done("connect source origin");
    lab.hivectl_done("connect origin worker");
    CHECK(runs(shell, "explain worker"));
    lab.hivectl_done("stop origin");
    const auto stopped = awaited(shell, "explain worker", "not_running origin");
    CHECK_MESSAGE(has(stopped.command(), "hivectl start " + file + " --as origin --listen tcp://0.0.0.0:77"),
                  stopped.text());
    CHECK_MESSAGE(stopped.command().ends_with(" --on cam1"), stopped.text());
    write("raise ValueError('division by cucumber')");
    cure(shell, stopped);
    lab.hivectl_done("connect source origin");  // it had forgotten its inputs
    const auto throws = awaited(shell, "explain worker", "throws origin");
    write("result.emit({'fine': True})");
    cure(shell, throws);
    CHECK(runs(shell, "explain worker"));
}

TEST_CASE("explain: a machine that is cut off, while a drone of this one has halted")
{
    if (!injectable(missing_for_lab()))
        return;
    const Two two;
    const auto shell = two.shell();
    BadLink link(two.from(), two.to(), {.delay = 1ms});
    two.to().hivectl_done("connect ticker worker");
    CHECK(runs(shell, "explain worker"));
    link.swallow();
    two.to().hivectl_done("halt worker");
    awaited(shell, "explain worker", "unreachable ticker, halted worker");
    CHECK(shell.run("hivectl explain worker").took < patient(2500ms));
    link.set({.delay = 1ms});
    two.to().hivectl_done("resume worker");
    CHECK(runs(shell, "explain worker"));
}

TEST_CASE("explain: a stream whose receiver is too slow")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"}),
               worker = swarm.drone("sleeper", "worker", {"work_ms=50"});
    swarm.hivectl_done({"connect", "source", "worker", "--stream"});
    const auto slow = awaited(swarm, "explain worker", "slow worker");
    CHECK(slow.exit_code == 0);
    CHECK_MESSAGE(has(slow.evidence(), " ms for each event"), slow.text());
    CHECK(slow.command() == "hivectl advise worker");
    swarm.hivectl_done({"set", "worker", "work_ms=0"});
    CHECK(runs(swarm, "explain worker"));
}

TEST_CASE("explain: a machine without the key, and one with another key")
{
    if (!injectable(missing_for_lab()))
        return;
    const Two two;
    const auto shell = two.shell();
    two.to().hivectl_done("connect ticker worker");
    CHECK(runs(shell, "explain worker"));
    const std::string key = "$HIVE_HOME/config/hive/swarm.key", kept = "$HIVE_HOME/kept";
    for (const std::string other : {"true", "hivectl key new"}) {
        REQUIRE(shell.run("mv " + key + " " + kept + " && " + other).exit_code == 0);
        const auto refused = awaited(shell, "explain worker", "refused ticker");
        CHECK_MESSAGE(has(refused.text(), "both ends need the same key"), refused.text());
        CHECK(refused.evidence() == "worker.image receives from it");
        CHECK(refused.command() == "hivectl key show");
        REQUIRE(shell.run("mv " + kept + " " + key).exit_code == 0);
        CHECK(runs(shell, "explain worker"));
    }
}
