// hivectl explain: what slows down or ends a connection between two machines, each caused for real, named and cured.
#include "bad_link.hpp"
#include "explained.hpp"

#include <possible.hpp>

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
    if (!possible(missing_for_lab()))
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

TEST_CASE("explain: a slow network")
{
    if (!possible(missing_for_lab()))
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

TEST_CASE("explain: a stream whose receiver is too slow")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"}),
               worker = swarm.drone("sleeper", "worker", {"work_ms=50"});
    swarm.hivectl_done({"connect", "source", "worker", "--stream"});
    const auto slow = awaited(swarm, "explain worker", "slow worker");
    CHECK(slow.exit_code == 0);
    CHECK_MESSAGE(has(slow.evidence(), " events dropped, 50"), slow.text());
    CHECK(slow.command() == "hivectl advise worker");
    swarm.hivectl_done({"set", "worker", "work_ms=0"});
    CHECK(runs(swarm, "explain worker"));
}

TEST_CASE("explain: a machine without the key, and one with another key")
{
    if (!possible(missing_for_lab()))
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
