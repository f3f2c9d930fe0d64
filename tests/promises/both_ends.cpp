// An edge has two ends, and what is lost at either is said of the edge.
#include "recorded.hpp"
#include "taking.hpp"

#include <hive/recording/reader.hpp>

#include <hive/event_text.hpp>

#include <csignal>

using namespace hive::test;
using hive::Json;

namespace {

/// Of the events between the first and the last of a recording, those that are not in it.
std::int64_t gaps_in(const std::filesystem::path& file)
{
    hive::recording::Reader reader(file);
    std::int64_t first = 0, last = 0, count = 0;
    for (; const auto record = reader.next(); ++count) {
        last = hive::event_from_text(reader.text(*record)).identity.sequence;
        first = count == 0 ? last : first;
    }
    return last - first + 1 - count;
}

}  // namespace

TEST_CASE("edges: what the queue of a slow receiver drops is on the edge, also in top")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=5000", "bytes=100"});
    const auto worker = swarm.drone("sleeper", "worker", {"work_ms=20"});
    auto application = swarm.application();
    application.connect({"source", "tick"}, {"worker", "image"}, {.transfer = hive::Transfer::streaming});
    std::int64_t dropped = 0;
    const auto at_either_end = [&] {
        return total(application, "worker", "dropped") + dropped_on(receivers(application, "source").at(0));
    };
    REQUIRE(eventually([&] { return (dropped = at_either_end()) > 100; }, 10'000ms));
    const auto rows = edges(swarm);
    REQUIRE(rows.size() == 1);
    CAPTURE(rows[0].dump());
    CHECK(dropped_on(rows[0]) >= dropped);
    const auto top = Json::parse(swarm.hivectl_done({"top", "--once", "--interval", "0.3", "--json"}));
    CAPTURE(top.dump());
    CHECK(is_dropping(top.at("edges").at(0)));
}

TEST_CASE("record: a recorder that was cut off says how much it lacks, and leaves with exit code 8")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100", "bytes=100"});
    const auto file = swarm.home() / "run.hive";
    auto application = swarm.application();
    auto recorder = swarm.hivectl_running({"record", "source", "-o", file.string(), "--json"}, "recorder");
    REQUIRE(eventually([&] { return recorded_in(file) > 20; }));
    recorder.signal(SIGSTOP);
    REQUIRE(eventually([&] { return receivers(application, "source").empty(); }, 10'000ms));
    const auto cut_off_at = produced(application, "source");
    REQUIRE(eventually([&] { return produced(application, "source") > cut_off_at + 20; }));
    recorder.signal(SIGCONT);
    REQUIRE(eventually([&] { return !receivers(application, "source").empty(); }, 10'000ms));
    const auto back_at = recorded_in(file);
    REQUIRE(eventually([&] { return recorded_in(file) > back_at + 20; }));
    recorder.signal(SIGINT);
    CHECK(recorder.wait(patient(5000ms)) == 8);
    const auto said = swarm.log("recorder");
    CAPTURE(said);
    std::int64_t lost = 0;
    const Json summary = Json::parse(said.substr(said.find('{')));
    for (const auto& loss : summary.at("lost"))
        lost += loss.at("events").get<std::int64_t>();
    REQUIRE(gaps_in(file) >= 20);  // else it proves nothing
    CHECK(lost >= gaps_in(file));
    CHECK(lost <= produced(application, "source") - recorded_in(file));
}
