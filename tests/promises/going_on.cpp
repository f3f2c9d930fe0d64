// A source that had ended goes on with another one: whoever collects behind it gets that, however long its first event
// takes, and not the end of the earlier one.
#include "taking.hpp"

#include <csignal>

using namespace hive::test;

namespace {

/// A source on demand whose first event after a set takes a while, and two drones behind it; it has ended.
struct Ended {
    Swarm swarm{};
    Process source = swarm.drone("ticker", "source", {"pace=demand", "count=2", "decode_ms=700"});
    Process first = swarm.drone("sleeper", "first"), second = swarm.drone("sleeper", "second");
    hive::Application application = swarm.application();
    int count = 2;

    Ended()
    {
        application.connect({"first", "result"}, {"second", "image"});
        application.connect({"source", "tick"}, {"first", "image"});
        CHECK(results() == 2);
        CHECK(results() == 0);
    }
    void go_on(int events) { application.set("source", {{"count", count += events}}); }
    /// How many `hivectl results` prints until it ends by itself.
    [[nodiscard]] std::ptrdiff_t results() const { return lines_of(swarm.hivectl_done({"results", "second"})); }
};

/// Its middle drone hears of the new source only when somebody collects already.
std::ptrdiff_t results_while_the_middle_is_late()
{
    Ended ended;
    ended.first.signal(SIGSTOP);
    ended.go_on(3);
    auto results = ended.swarm.hivectl_running({"results", "second"}, "results");
    CHECK(eventually([&] {  // or it has believed the end and is gone already
        return !receivers(ended.application, "second").empty() || results.wait(Milliseconds(0));
    }));
    rest(*ended.application.exceptions({"second"}));  // a while, in which the end of the old source would be believed
    ended.first.signal(SIGCONT);
    CHECK(results.wait(patient(10'000ms)) == 0);
    return lines_of(ended.swarm.log("results"));
}

}  // namespace

TEST_CASE("going on: hivectl results prints those of a source that has just been set, behind two drones")
{
    Ended ended;
    for (int i = 1; i <= 3; ++i) {
        ended.go_on(i);
        CHECK(ended.results() == i);
        CHECK(ended.results() == 0);
    }
}

TEST_CASE("going on: a collector that had everything gets what another source gives, without a pause of its own")
{
    Ended ended;
    const auto collector = ended.application.collect({{"second", "result"}});
    const auto all = [&] {
        int count = 0;
        while (collector->next(patient(10'000ms)))
            ++count;
        return count;
    };
    CHECK(all() == 0);
    for (int i = 1; i <= 3; ++i) {
        REQUIRE(collector->ended() == "");
        ended.go_on(i);
        CHECK(all() == i);
    }
}

TEST_CASE("going on: whoever had everything hears at once that there is more, whoever set it")
{
    Ended ended;
    auto other = ended.swarm.application();
    const auto collector = other.collect({{"second", "result"}});
    CHECK_FALSE(collector->next(patient(10'000ms)));
    REQUIRE(collector->ended() == "");
    ended.application.set("source", {{"count", 3}, {"decode_ms", 60'000}});
    CHECK(eventually([&] { return !collector->ended(); }));
    CHECK(rest(*collector) == 0);
    ended.application.set("source", {{"decode_ms", 0}});
    CHECK(take(*collector, 1).size() == 1);
}

TEST_CASE("going on: a drone in between that is late is asked, so its old end is not believed")
{
    CHECK(results_while_the_middle_is_late() == 3);
}

TEST_CASE("going on: without the question the old end is believed")
{
    const SwitchedOff question("end-question");
    CHECK(results_while_the_middle_is_late() == 0);
}

TEST_CASE("going on: a sender that does not answer holds up an end for two seconds, not for good")
{
    const Ended ended;
    ended.first.signal(SIGSTOP);
    const auto begun = Clock::now();
    CHECK(ended.results() == 0);
    CHECK(Clock::now() - begun < patient(6'000ms));
    ended.first.signal(SIGCONT);
}

TEST_CASE("going on: a source that is replaced after its end is waited for")
{
    const Swarm swarm;
    swarm.hivectl_done({"start", "ticker", "--as", "source", "pace=demand", "count=2", "decode_ms=700"});
    const auto worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "source", "worker"});
    CHECK(lines_of(swarm.hivectl_done({"results", "worker"})) == 2);
    swarm.hivectl_done({"replace", "source", "count=3"}, 40'000ms);
    CHECK(lines_of(swarm.hivectl_done({"results", "worker"})) == 3);
}

TEST_CASE("going on: a replay that has ended and is set again has more to give before it gives it")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=5"});
    const auto file = (swarm.home() / "run.hive").string();
    swarm.hivectl_done({"record", "source", "-o", file});
    const auto replay = swarm.drone("replay", "replay", {"file=" + file, "pace=demand"});
    CHECK(lines_of(swarm.hivectl_done({"results", "replay.tick"})) == 5);
    swarm.hivectl_done({"halt", "replay"});
    swarm.hivectl_done({"set", "replay", "speed=2"});
    CHECK(swarm.hivectl({"results", "replay.tick", "--timeout", "0.5"}).exit_code == 124);
    swarm.hivectl_done({"resume", "replay"});
    CHECK(lines_of(swarm.hivectl_done({"results", "replay.tick"})) == 5);
}

TEST_CASE("going on: members of a group that were told of the end are told, whichever of them gets the next event")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=4", "decode_ms=500"});
    const auto one = swarm.drone("sleeper", "worker-1"), two = swarm.drone("sleeper", "worker-2");
    swarm.hivectl_done({"connect", "source", "worker-1", "worker-2", "--share"});
    CHECK(lines_of(swarm.hivectl_done({"results", "worker-1", "worker-2"})) == 4);
    for (int count = 5; count < 8; ++count) {
        swarm.hivectl_done({"set", "source", "count=" + std::to_string(count)});
        CHECK(lines_of(swarm.hivectl_done({"results", "worker-1", "worker-2"})) == 1);
    }
}

TEST_CASE("going on: what is lacking is what the last source lacked")
{
    Ended ended;
    ended.application.set("first", {{"throw_every", 2}});
    ended.go_on(4);
    const auto damaged = ended.swarm.hivectl({"results", "second"});
    CHECK(damaged.exit_code == 8);
    CHECK_MESSAGE(damaged.err.find("first failed at 2 events") != std::string::npos, damaged.err);
    ended.application.set("first", {{"throw_every", 0}});
    ended.go_on(1);
    CHECK(ended.results() == 1);
}
