// Nothing lost: what a source on demand gives gets to every receiver, and a source that is held up says by whom and can
// be let go.
#include "taking.hpp"

using namespace hive::test;

namespace {

constexpr int given = 60;

/// Two plain workers at the outputs `first` and `second` of a source that gives `given` of each; one of them is killed
/// in the middle and started again.
struct KilledReceiver {
    const Swarm& swarm;
    Process first{swarm.drone("sleeper", "w1", {"work_ms=10"})}, second{swarm.drone("sleeper", "w2", {"work_ms=10"})};
    hive::Application application{swarm.application()};
    std::unique_ptr<hive::Collector> of_first{application.collect({{"w1", "result"}})},
        of_second{application.collect({{"w2", "result"}})};

    /// What came of the worker that was killed, and of the other.
    std::pair<Sequences, Sequences> run(const hive::Endpoint& to_first, const hive::Endpoint& to_second,
                                        Milliseconds timeout)
    {
        application.halt(to_first.drone);
        application.connect(to_first, {"w1", "image"});
        application.connect(to_second, {"w2", "image"});
        application.resume(to_first.drone);
        auto taken = take(*of_first, given / 3);
        first.kill();
        auto others = take(*of_second, given / 2, 300ms);  // fewer where the source waits for the one that is gone
        first = swarm.drone("sleeper", "w1");
        std::ranges::copy(take(*of_first, given - taken.size(), timeout), std::back_inserter(taken));
        std::ranges::copy(take(*of_second, given - others.size(), timeout), std::back_inserter(others));
        return {taken, others};
    }
};

}  // namespace

TEST_CASE("lossless: a slow receiver of a stream on demand loses nothing")
{
    constexpr std::int64_t count = 6000;
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "bytes=100", "count=" + std::to_string(count)});
    const auto worker = swarm.drone("sleeper", "worker", {"work_ms=1500"});
    auto application = swarm.application();
    const auto collector = application.collect({{"worker", "result"}});
    application.connect({"source", "tick"}, {"worker", "image"}, {.transfer = hive::Transfer::streaming});
    REQUIRE(eventually([&] { return is_busy(application, "worker"); }));
    application.set("worker", {{"work_ms", 0}});  // when the first event is done
    const auto results = take(*collector, count);
    CHECK(results.size() == count);
    CHECK((results == one_to(count)));
    for (const auto& edge : edges(swarm))
        CHECK_MESSAGE(dropped_on(edge) == 0, edge.dump());
}

TEST_CASE("lossless: a plain receiver of a source on demand that is killed and comes back has missed nothing")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=" + std::to_string(given)});
    KilledReceiver receivers{swarm};
    const auto [taken, others] = receivers.run({"source", "tick"}, {"source", "tick"}, 5000ms);
    CHECK(listed(taken) == listed(one_to(given)));
    CHECK(listed(others) == listed(one_to(given)));
}

TEST_CASE("lossless: a plain receiver of a replay of two outputs that is killed and comes back has missed nothing")
{
    const Swarm swarm;
    const auto file = (swarm.home() / "run.hive").string();
    const auto count = "count=" + std::to_string(given);
    {
        const auto left = swarm.drone("ticker", "left", {"pace=demand", count}),
                   right = swarm.drone("ticker", "right", {"pace=demand", count});
        swarm.hivectl_done({"record", "left", "right", "-o", file, "-n", std::to_string(2 * given)});
    }
    const auto replay = swarm.drone("replay", "replay", {"file=" + file, "pace=demand"});
    KilledReceiver receivers{swarm};
    const auto [taken, others] = receivers.run({"replay", "left-tick"}, {"replay", "right-tick"}, 5000ms);
    CHECK(listed(sorted(taken)) == listed(sorted(others)));
    CHECK(taken.size() == given);
}

TEST_CASE("lossless: when a killed receiver's place is not kept, it misses events")
{
    const SwitchedOff places("places");
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=" + std::to_string(given)});
    KilledReceiver receivers{swarm};
    const auto [taken, others] = receivers.run({"source", "tick"}, {"source", "tick"}, 1000ms);
    CHECK(std::set(taken.begin(), taken.end()).size() < given);
    CHECK(listed(others) == listed(one_to(given)));
}

TEST_CASE("lossless: an output that nobody receives holds up no other output of the drone")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=30"});
    const auto fork = swarm.drone("fork", "fork");
    auto application = swarm.application();
    application.connect({"source", "tick"}, {"fork", "in"});
    REQUIRE(
        eventually([&] { return total(application, "fork", "processed") > 0; }));  // now both outputs have something
    const auto collector = application.collect({{"fork", "left"}});
    CHECK(listed(take(*collector, 30, 2000ms)) == listed(one_to(30)));
}

TEST_CASE("lossless: a source that waits for a group without members says so, and disconnecting who is gone lets it go")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"});
    auto member = swarm.drone("sleeper", "member", {"work_ms=10"});
    const auto plain = swarm.drone("sleeper", "plain", {"work_ms=10"});
    auto application = swarm.application();
    const auto results = application.collect({{"member", "result"}}),
               others = application.collect({{"plain", "result"}});
    swarm.hivectl_done({"connect", "source", "member", "--share"});
    REQUIRE(take(*results, 3).size() == 3);
    member.kill();
    swarm.hivectl_done({"stop", "member"});  // it will not come back
    swarm.hivectl_done({"connect", "source", "plain"});
    CHECK(eventually([&] { return says(application, "source", "group_awaited"); }, 2000ms));
    CHECK(has(swarm.hivectl_done({"connections", "--json"}), "group_awaited"));
    const auto released = swarm.hivectl({"disconnect", "source", "member"});
    CAPTURE(released.err);
    CHECK(released.exit_code == 0);
    CHECK(take(*others, 3, 2000ms).size() == 3);
}
