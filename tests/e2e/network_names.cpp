// Names across machines when the machine with a name, or its clock, fails.
#include "lab.hpp"
#include "wall_clock.hpp"

#include <possible.hpp>

#include <csignal>
#include <cstdlib>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

Json row_of(const std::string& rows, const std::string& name)
{
    for (const auto& row : Json::parse(rows))
        if (row.at("name") == name)
            return row;
    return nullptr;
}

/// The time until ps shows a drone as anything but up.
Seconds until_not_up(const Lab& lab, const std::string& drone)
{
    const auto begin = Clock::now();
    REQUIRE(eventually([&] {
        const auto row = row_of(lab.hivectl_done("ps --json"), drone);
        return row.is_null() || row.at("state") == "unreachable" || row.at("state") == "silent";
    }));
    return Clock::now() - begin;
}

Seconds start_takes(const Lab& lab, const std::string& name)
{
    const auto begin = Clock::now();
    lab.hivectl_done("start ticker --as " + name + " --on gpu1");
    return Clock::now() - begin;
}

}  // namespace

TEST_CASE("network names: a drone that died or whose machine is gone is not shown as up, and its name is soon free")
{
    if (!possible(missing_for_lab()))
        return;
    const Lab lab({"cam1", "gpu1"});
    lab.share_key();
    lab.hivectl_done("start ticker --on cam1");
    lab.hivectl_done("start ticker --as far --on cam1");
    const auto usual = start_takes(lab, "other");
    ::kill(row_of(lab.hivectl_done("ps --json"), "ticker").at("pid").get<pid_t>(), SIGKILL);
    const auto seen_dead = until_not_up(lab, "ticker");
    const auto after_death = start_takes(lab, "ticker");
    lab.cut(0);
    const auto seen_gone = until_not_up(lab, "far");
    const auto after_cut = start_takes(lab, "far");
    MESSAGE("not up after " << seen_dead.count() << " s when it was killed, " << seen_gone.count()
                            << " s when its machine was cut off; started elsewhere in " << after_death.count()
                            << " and " << after_cut.count() << " s, one of another name in " << usual.count() << " s");
    CHECK(seen_dead < stated(2500ms));
    CHECK(seen_gone < stated(2500ms));
    CHECK(after_death - usual < stated(2500ms));
    CHECK(after_cut - usual < stated(2500ms));
    CHECK(row_of(lab.hivectl_done("ps --json"), "far").at("host") == "gpu1");
    lab.mend(0);
    const auto ghost = lab.shell("hivectl get far fps");  // the list of places has only the new one
    CHECK_MESSAGE(ghost.exit_code == 0, ghost.err);
}

TEST_CASE("network names: top shows a clock that is an hour wrong, and the ages of what comes from there are right")
{
    if (!possible(missing_for_lab()))
        return;
    if (!possible(WallClock::missing()))
        return;
    const Lab lab({"cam1", "gpu1"});
    lab.share_key();
    const auto &cam1 = lab.machine(0), &gpu1 = lab.machine(1);
    const WallClock clock(lab.directory());
    std::string variables = "env";
    for (const auto& variable : clock.environment())
        variables += " " + variable;
    cam1.net.run(variables + " " + cam1.swarm.program("hivectl").string() + " start ticker --listen tcp://"
                 + cam1.address + ":7700");
    gpu1.hivectl_done("start sleeper");
    gpu1.hivectl_done("place add ticker tcp://" + cam1.address + ":7700");
    gpu1.hivectl_done("connect ticker sleeper --stream");
    auto application = gpu1.swarm.application();
    const auto input = [&] { return application.status("sleeper").inputs.at(0); };
    REQUIRE(eventually([&] { return input().connected && input().round_trip_us > 0; }));
    const auto registration = input().registration;
    for (const std::int64_t seconds : {3600, -3600}) {
        CAPTURE(seconds);
        clock.set((seconds > 0 ? "+" : "") + std::to_string(seconds));
        const auto begin = Clock::now();
        const auto wrong_by = [&] { return std::abs(input().clock_offset_us / 1'000'000 - seconds); };
        REQUIRE(eventually([&] { return wrong_by() <= 1; }, 30'000ms));
        const Seconds known = Clock::now() - begin;
        CHECK(eventually([&] { return std::abs(input().last_age_us) < 1'000'000; }));
        const auto now = input();  // by the clocks alone it would be an hour wrong
        CHECK(std::abs(now.last_age_us - now.clock_offset_us) > 3000'000'000);
        const auto top = gpu1.swarm.run(
            gpu1.net.inside({gpu1.swarm.program("hivectl").string(), "top", "--once", "--interval", "0.2", "--json"}));
        const auto explained =
            gpu1.swarm.run(gpu1.net.inside({gpu1.swarm.program("hivectl").string(), "explain", "sleeper"}));
        CHECK_MESSAGE(has(explained.out, std::string(seconds > 0 ? " ahead of" : " behind") + " that of this machine"),
                      explained.out, explained.err);
        MESSAGE("the offset was known after " << known.count() << " s");
        const auto shown = Json::parse(top.out).at("edges").at(0).at("skew_us").get<std::int64_t>();
        CHECK(std::abs(shown / 1'000'000 - seconds) <= 1);
    }
    CHECK(input().registration == registration);
}
