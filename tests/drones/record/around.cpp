// A recorder that keeps the last seconds, and writes a file around each event that fits.
#include "measure.hpp"
#include "status_sums.hpp"

#include <hive/event_text.hpp>
#include <hive/recording/reader.hpp>

#include <doctest/doctest.h>
#include <possible.hpp>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;
using hive::recording::Reader;

namespace {

/// The marks in a file in their order, and how many ticks stand before the first of them and behind it.
struct Clip {
    explicit Clip(const std::filesystem::path& file)
    {
        Reader reader(file);
        problem = reader.problem();
        ended = reader.summary().ended;
        while (const auto record = reader.next()) {
            const auto event = hive::event_from_text(reader.text(*record));
            if (event.header.contains("door"))
                marks.push_back(event.header.at("door"));
            else
                ++(marks.empty() ? before : behind);
        }
    }
    std::string problem, ended;
    std::vector<std::string> marks;
    int before = 0, behind = 0;
};

}  // namespace

TEST_CASE("recording around an event: each file has what came shortly before and after")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100", "bytes=1000"});
    const auto recorder =
        swarm.drone("record", "record",
                    {"file=" + (swarm.home() / "door.hive").string(), "when=door=open", "before=0.5", "after=0.5"});
    auto application = swarm.application();
    application.connect({"source", ""}, {"record", ""}, {.window = 64, .group = {}, .lease = {}});
    const auto processed = [&] { return at_inputs(application.status("record"), &hive::InputStatus::processed); };
    const auto condition = [&] { return application.status("record").condition; };
    const auto mark = [&](const char* door) {
        application.put({"record", "events"}, Json{{"door", door}}, hive::Body(), "text/plain");
    };
    REQUIRE(eventually([&] { return processed() > 150; }));
    CHECK(condition() == "waiting for door=open");
    mark("closed");
    CHECK(condition() == "waiting for door=open");
    for (const char* file : {"door.hive", "door-2.hive"}) {
        mark("open");
        mark("open");
        CHECK(eventually([&] { return condition() == "recording " + (swarm.home() / file).string(); }));
        REQUIRE(eventually([&] { return condition() == "waiting for door=open"; }));
        const Clip clip(swarm.home() / file);
        CHECK(clip.problem.empty());
        CHECK(clip.ended == "the event is over");
        CHECK(std::ranges::count(clip.marks, "open") == 2);
        CHECK(clip.before >= 10);
        CHECK_MESSAGE(clip.before <= 60, "half a second at 100 fps");
        CHECK(clip.behind >= 10);
    }
    CHECK_FALSE(std::filesystem::exists(swarm.home() / "door-3.hive"));
    CHECK(swarm.hivectl({"set", "record", "when=door=>1"}).exit_code != 0);
    CHECK_MESSAGE(swarm.hivectl({"set", "record", "when="}).exit_code != 0, "door.hive is there");
    CHECK(condition() == "waiting for door=open");
    swarm.hivectl_done({"set", "record", "when=", "file=all.hive"});
    REQUIRE(eventually([&] { return std::filesystem::exists(swarm.home() / "all.hive"); }));
    mark("closed");
    application.stop("record");
    const Clip all(swarm.home() / "all.hive");
    CHECK(all.marks == std::vector<std::string>{"closed"});
}

TEST_CASE("recording around an event: the end of the source ends the file, which has all that came before")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=40", "bytes=10"});
    const auto file = swarm.home() / "tick.hive";
    const std::vector<std::string> settings{"file=" + file.string(), "when=index=20", "before=100", "after=100"};
    auto application = swarm.application();
    application.halt("source");
    {
        const auto recorder = swarm.drone("record", "record", settings);
        application.connect({"source", ""}, {"record", ""}, {.window = 64, .group = {}, .lease = {}});
        application.resume("source");
        REQUIRE(eventually([&] { return has(swarm.log("record"), "closed " + file.string()); }));
    }
    const Clip clip(file);
    CHECK(clip.before == 40);
    CHECK(clip.ended == "end of source");
    CHECK(clip.problem.empty());
}
