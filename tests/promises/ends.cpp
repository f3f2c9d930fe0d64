// The end of a source travels behind everything that came before it, and who collects knows that it has everything.
#include "taking.hpp"

#include <algorithm>
#include <sstream>

using namespace hive::test;

namespace {

std::string counted(int events) { return "count=" + std::to_string(events); }

/// The sequences of the lines that `hivectl results` printed.
Sequences printed(const std::string& lines)
{
    Sequences sequences;
    std::istringstream text(lines);
    for (std::string line; std::getline(text, line);)
        sequences.push_back(hive::Json::parse(line).at("seq"));
    return sequences;
}

/// Everything until the collector has ended; what it says about the end.
std::pair<Sequences, std::optional<std::string>> take_all(hive::Collector& collector)
{
    Sequences sequences;
    while (const auto event = collector.next(patient(10'000ms)))
        sequences.push_back(event->identity.sequence);
    return {sequences, collector.ended()};
}

std::vector<hive::Endpoint> results_of(int workers)
{
    std::vector<hive::Endpoint> ends;
    for (int i = 1; i <= workers; ++i)
        ends.push_back({"worker-" + std::to_string(i), "result"});
    return ends;
}

}  // namespace

TEST_CASE(
    "end: hivectl results of a source on demand prints everything and ends by itself, straight and behind a drone")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", counted(40)});
    const auto worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "source", "worker"});
    CHECK(printed(swarm.hivectl_done({"results", "worker"})) == one_to(40));
    CHECK(printed(swarm.hivectl_done({"results", "worker"})).empty());  // who comes later is told at once
    CHECK(swarm.hivectl({"results", "worker", "--stay", "--timeout", "0.3"}).exit_code == 124);
    auto application = swarm.application();
    CHECK(says(application, "source", "source_ended"));
    CHECK(says(application, "worker", "source_ended"));
}

TEST_CASE("end: of a live source the last event comes before the end, whoever is slow")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=0.1", counted(100)});
    const auto worker = swarm.drone("sleeper", "worker", {"work_ms=30"});
    auto application = swarm.application();
    const auto collector = application.collect({{"worker", "result"}});
    application.connect({"source", "tick"}, {"worker", "image"});
    application.set("source", {{"fps", 200.0}});  // it comes to its end only when it is received
    const auto [sequences, end] = take_all(*collector);
    REQUIRE_FALSE(sequences.empty());
    CHECK(sequences.back() == 100);
    CHECK(sequences.size() < 100);
    CHECK(end == "");
}

TEST_CASE("end: behind workers that share, one of which is killed, everything comes and then the end")
{
    const Swarm swarm;
    const auto source =
        swarm.drone("ticker", "source", {"pace=demand", counted(60)},
                    {"--expect", "worker-1.image", "--expect", "worker-2.image", "--expect", "worker-3.image"});
    std::vector<Process> workers;
    for (int i = 1; i <= 3; ++i)
        workers.push_back(swarm.drone("sleeper", "worker-" + std::to_string(i), {"work_ms=10"}));
    auto application = swarm.application();
    const auto collector = application.collect(results_of(3), in_order);
    for (int i = 1; i <= 3; ++i)
        application.connect({"source", "tick"}, {"worker-" + std::to_string(i), "image"}, member_of("all", 2));
    auto sequences = take(*collector, 20);
    workers[1].kill();
    const auto [rest, end] = take_all(*collector);
    sequences.insert(sequences.end(), rest.begin(), rest.end());
    CHECK(sequences == one_to(60));
    CHECK(end == "");
    CHECK(collector->counts().missing == 0);
    for (const auto* worker : {"worker-1", "worker-3"})
        swarm.hivectl_done({"stop", worker});
    CHECK_FALSE(collector->next(300ms));
    CHECK(collector->ended() == "");  // the others did the work of the one that was killed
}

TEST_CASE("end: a worker that was killed is replaced by one that shares the work of two senders with it")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", counted(30)},
                                    {"--expect", "one.image", "--expect", "two.image"});
    const auto one = swarm.drone("sleeper", "one"), two = swarm.drone("sleeper", "two");
    const auto worker = swarm.drone("sleeper", "worker-1", {"work_ms=5"});
    auto killed = swarm.drone("sleeper", "worker-2", {"work_ms=5"});
    auto application = swarm.application();
    const auto collector = application.collect(results_of(2));
    for (const auto* sender : {"one", "two"})
        for (const auto* member : {"worker-1", "worker-2"})
            application.connect({sender, "result"}, {member, "image"}, member_of("all", 2));
    application.connect({"source", "tick"}, {"one", "image"});
    application.connect({"source", "tick"}, {"two", "image"});
    const auto came = take(*collector, 30).size();
    killed.kill();
    const auto [others, end] = take_all(*collector);
    CHECK(came + others.size() == 60);
    CHECK(end == "");
}

TEST_CASE("end: it goes through a drone with two inputs when both have come to it, and sets end too")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", counted(20)});
    const auto fork = swarm.drone("fork", "fork"), join = swarm.drone("join", "join");
    auto application = swarm.application();
    const auto sets = application.collect_matched({{"fork", "left"}, {"fork", "right"}});
    const auto joined = application.collect({{"join", "counts"}});
    application.connect({"fork", "left"}, {"join", "left"});
    application.connect({"fork", "right"}, {"join", "right"});
    application.connect({"source", "tick"}, {"fork", "in"});
    std::size_t complete = 0, counts = 0;
    for (const auto until = Clock::now() + patient(10'000ms);
         Clock::now() < until && !(sets->ended() && joined->ended());) {
        complete += sets->next(5ms) ? 1 : 0;
        counts += joined->next(5ms) ? 1 : 0;
    }
    CHECK(sets->ended() == "");
    CHECK(joined->ended() == "");
    CHECK(complete == 20);
    CHECK(counts == 40);
}

TEST_CASE("end: it is taken back when the source has more, and by another connection")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", counted(5)});
    const auto worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    const auto collector = application.collect({{"worker", "result"}});
    application.connect({"source", "tick"}, {"worker", "image"});
    CHECK(take_all(*collector).first == one_to(5));
    application.set("source", {{"count", 8}});
    std::optional<hive::Event> first;
    REQUIRE(eventually([&] { return (first = collector->next(50ms)).has_value(); }));
    CHECK(first->identity.sequence == 1);  // another source: a new epoch, numbered from 1
    const auto [rest, end] = take_all(*collector);
    CHECK(rest == Sequences{2, 3});
    CHECK(end == "");
    const auto other = swarm.drone("ticker", "other", {"fps=100"});
    application.connect({"other", "tick"}, {"worker", "image"});
    CHECK(eventually([&] { return !collector->ended(); }));
    CHECK(take(*collector, 3).size() == 3);
}

TEST_CASE("end: a recording ends with its source, and a replay of it ends too")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", counted(30)});
    const auto file = (swarm.home() / "run.hive").string();
    const auto said = swarm.hivectl_done({"record", "source", "-o", file});
    CHECK_MESSAGE(has(said, "30 events"), said);
    const auto replay = swarm.drone("replay", "replay", {"file=" + file, "pace=demand"});
    CHECK(printed(swarm.hivectl_done({"results", "replay.tick"})) == one_to(30));
}

TEST_CASE("end: a picture that was made when nobody received it waits for whoever comes first, as boxes do")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=scene:plain", "pace=demand", "width=64", "height=64"});
    const auto face = swarm.drone("face", "face");
    swarm.hivectl_done({"connect", "camera", "face"});
    auto application = swarm.application();
    REQUIRE(eventually([&] { return total(application, "face", "received") == 1; }));
    CHECK(take(*application.collect({{"face", "annotated"}}), 2) == one_to(2));
}

TEST_CASE("end: it waits for a sender that was lost, and not for one that was stopped")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", counted(40)},
                                    {"--expect", "quick.image", "--expect", "slow.image"});
    const auto quick = swarm.drone("sleeper", "quick");
    auto slow = swarm.drone("sleeper", "slow", {"work_ms=20"});
    auto application = swarm.application();
    const auto results = application.collect({{"quick", "result"}, {"slow", "result"}});
    application.connect({"source", "tick"}, {"quick", "image"}, {.window = 4});
    application.connect({"source", "tick"}, {"slow", "image"}, {.window = 4});
    const auto came = take(*results, 70).size();
    SUBCASE("killed, and started again later than quick has ended")
    {
        slow.kill();
        const auto meanwhile = rest(*results, 2500ms);
        CHECK(came + meanwhile < 80);
        CHECK_FALSE(results->ended());
        slow = swarm.drone("sleeper", "slow");
        const auto [others, end] = take_all(*results);
        CHECK(came + meanwhile + others.size() == 80);
        CHECK(end == "");
    }
    SUBCASE("stopped")
    {
        swarm.hivectl_done({"stop", "slow"});
        const auto [others, end] = take_all(*results);
        CHECK(end == "");
    }
}

TEST_CASE("end: it says at how many events a drone on the way failed, and the verbs exit with 8")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", counted(40)});
    const auto worker = swarm.drone("sleeper", "worker", {"throw_every=2"});
    const auto last = swarm.drone("sleeper", "last");
    swarm.hivectl_done({"connect", "worker", "last"});
    const auto recorder = swarm.drone("record", "recorder", {"file=" + (swarm.home() / "run.hive").string()});
    swarm.hivectl_done({"connect", "last", "recorder"});
    swarm.hivectl_done({"connect", "source", "worker"});
    const auto done = swarm.hivectl({"results", "last"});
    CHECK(done.exit_code == 8);
    CHECK(done.err.find("incomplete: worker failed at 20 events") != std::string::npos);
    CHECK(eventually([&] {
        return swarm.hivectl_done({"ps", "recorder"}).find("worker failed at 20 events") != std::string::npos;
    }));
}
