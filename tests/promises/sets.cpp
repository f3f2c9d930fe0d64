// One set for many drones: all of them have the new values or none has, whoever is slow, refuses, is stopped or gives
// up in between; what cannot be known is called unknown.
#include "taking.hpp"

#include <csignal>

using namespace hive::test;

namespace {

/// Two workers, of which the second is busy with one event for a while, so that a set on both takes as long.
class OneBusy {
public:
    /// @param most_ms  a longer work_ms is refused by the second worker's own code
    explicit OneBusy(int most_ms)
        : most_ms_(most_ms),
          second_(swarm_.drone("sleeper", "s2", {"work_ms=3000", "most_ms=" + std::to_string(most_ms)}))
    {
        keep_busy(application_, "s2");
    }

    [[nodiscard]] const Swarm& swarm() const { return swarm_; }
    [[nodiscard]] Process& second() { return second_; }
    /// The value of the first and of the second.
    std::pair<int, int> values() { return {value("s1"), value("s2")}; }
    /// The set on both, running. Returns when the first has the value, or when it is clear that it does not get it
    /// before the second has agreed.
    [[nodiscard]] Process set_both(int work_ms)
    {
        auto command = swarm_.hivectl_running({"set", "s*", "work_ms=" + std::to_string(work_ms)}, "set");
        REQUIRE(is_busy(application_, "s2"));
        happens_within(300ms, [&] { return value("s1") == work_ms; });
        return command;
    }
    /// Returns when the second has dealt with all that it was asked to set.
    void settle()
    {
        const auto most = "most_ms=" + std::to_string(most_ms_);
        REQUIRE(eventually([&] { return swarm_.hivectl({"set", "s2", most, "--timeout", "10"}).exit_code == 0; }));
    }

private:
    int value(const std::string& drone) { return application_.get(drone, {"work_ms"}).at("work_ms"); }

    Swarm swarm_;
    hive::Application application_{swarm_.application()};
    int most_ms_;
    Process first_{swarm_.drone("sleeper", "s1", {"work_ms=10"})}, second_;
};

const std::pair before{10, 3000};

}  // namespace

TEST_CASE("set: a value that was confirmed is not taken away by a set on many that ends in a refusal")
{
    OneBusy drones(5000);
    auto both = drones.set_both(9000);
    const auto one = drones.swarm().hivectl({"set", "s1", "work_ms=77", "--timeout", "10"});
    REQUIRE(both.wait(patient(10'000ms)));
    CHECK(both.wait(0ms) != 0);
    CHECK(drones.values().first == (one.exit_code == 0 ? 77 : 10));
    CHECK(drones.values().second == 3000);
}

TEST_CASE("set: Ctrl-C in the middle of a set on many leaves all as they were, or all as they were to be")
{
    int value = 0;
    SUBCASE("that one of them would have refused") { value = 9000; }
    SUBCASE("that all of them would have taken") { value = 50; }
    OneBusy drones(5000);
    auto both = drones.set_both(value);
    both.signal(SIGINT);
    REQUIRE(both.wait(patient(10'000ms)));
    drones.settle();
    const auto [first, second] = drones.values();
    CAPTURE(first);
    CAPTURE(second);
    CHECK((drones.values() == before || (first == value && second == value)));
}

TEST_CASE("set: a drone that is stopped in the middle of a set on many has what the others have, or is called unknown")
{
    OneBusy drones(600'000);
    auto both = drones.set_both(77);
    drones.second().signal(SIGSTOP);
    REQUIRE(both.wait(patient(10'000ms)));
    drones.second().signal(SIGCONT);
    drones.settle();
    const auto said = drones.swarm().log("set");
    const auto [first, second] = drones.values();
    CAPTURE(said);
    CAPTURE(first);
    CAPTURE(second);
    CHECK((has(said, "unknown") || drones.values() == before || (first == 77 && second == 77)));
}

TEST_CASE("set: when one of many takes longer than the set may, all have the new values or none has")
{
    const Swarm swarm;
    const auto first = swarm.drone("fork", "t1"), second = swarm.drone("fork", "t2", {"slow_ms=1200"});
    const auto set = swarm.hivectl({"set", "t*", "mark=3", "--timeout", "0.4"});
    REQUIRE(eventually([&] { return swarm.hivectl({"set", "t2", "slow_ms=0", "--timeout", "10"}).exit_code == 0; }));
    const auto mark = swarm.hivectl_done({"get", "t1", "mark"});
    CAPTURE(set.err);
    CHECK(mark == (set.exit_code == 0 ? "3\n" : "0\n"));
    CHECK(swarm.hivectl_done({"get", "t2", "mark"}) == mark);
}
