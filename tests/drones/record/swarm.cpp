// Recording and replaying with real drones: nothing is changed, and no loss is silent, however the recorder ends.
#include "measure.hpp"
#include "recorded.hpp"
#include "status_sums.hpp"

#include <hive/event_text.hpp>
#include <hive/recording/reader.hpp>

#include <doctest/doctest.h>
#include <possible.hpp>

#include <csignal>
#include <fstream>
#include <utility>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;
using hive::recording::Reader;

namespace {

namespace fs = std::filesystem;

constexpr hive::ConnectionOptions wide{.window = 64, .group = {}, .lease = {}};

/// Everything that an event is, as bytes; except the shares on its way.
std::string bytes_of(hive::Event event)
{
    event.identity.shares.clear();
    return hive::event_text(event) + '\n'
           + std::string(reinterpret_cast<const char*>(event.body.data()), event.body.size());
}

/// The same, except for the sender.
std::string bytes_without_sender(hive::Event event)
{
    event.sender = event.kind = event.output = "any";
    return bytes_of(event);
}

std::vector<hive::Event> take(hive::Collector& collector, std::size_t count)
{
    std::vector<hive::Event> events;
    while (events.size() < count) {
        auto event = collector.next(patient(5000ms));
        REQUIRE_MESSAGE(event, "only ", events.size(), " events of ", count, " came");
        event->body = hive::Body(std::string(reinterpret_cast<const char*>(event->body.data()),
                                             event->body.size()));  // not kept in shared memory
        event->ticket = {};
        events.push_back(std::move(*event));
    }
    return events;
}

std::vector<hive::Event> replayed(const Swarm& swarm, const fs::path& file, std::size_t count)
{
    const auto drone = swarm.drone("replay", "replay", {"file=" + file.string(), "pace=demand"});
    auto application = swarm.application();
    const auto collector = application.collect({{"replay", "tick"}});
    auto events = take(*collector, count);
    CHECK(eventually([&] { return application.status("replay").condition == "end of recording"; }));
    CHECK_FALSE(collector->next(0ms));
    application.stop("replay");
    return events;
}

/// The sequences of the readable events, which must have no gap.
std::int64_t contiguous_events(Reader& reader)
{
    std::int64_t count = 0, last = 0;
    while (const auto record = reader.next()) {
        const auto event = hive::event_from_text(reader.text(*record));
        std::vector<std::byte> body(record->prefix.body_size);
        reader.body(*record, body);
        CHECK((last == 0 || event.identity.sequence == last + 1));
        CHECK(body.size() == event.size);
        last = event.identity.sequence;
        ++count;
    }
    return count;
}

std::int64_t lost_in(const Reader& reader)
{
    std::int64_t lost = 0;
    for (const auto& loss : reader.summary().lost)
        lost += loss.events;
    return lost;
}

}  // namespace

TEST_CASE("recording: ten thousand events on demand come back as they were, twice the same to the byte")
{
    constexpr std::size_t count = 10'000;
    const Swarm swarm;
    const auto file = swarm.home() / "run.hive";
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=10000", "bytes=100", "padding=1024"});
    const auto recorder = swarm.drone("record", "record", {"file=" + file.string()});
    auto application = swarm.application();
    application.halt("source");
    application.connect({"source", ""}, {"record", ""}, wide);
    const auto collector = application.collect({{"source", "tick"}});
    application.resume("source");
    const auto originals = take(*collector, count);
    REQUIRE(
        eventually([&] { return at_inputs(application.status("record"), &hive::InputStatus::processed) == count; }));
    REQUIRE(eventually([&] { return has(application.status("record").condition, "ended: end of source"); }));
    application.stop("record");
    {
        const Reader reader(file);
        CHECK(reader.problem() == "");
        CHECK(reader.summary().ended == "end of source");
        CHECK(reader.summary().events() == count);
        CHECK(reader.summary().lossless());
    }
    const auto first = replayed(swarm, file, count), second = replayed(swarm, file, count);
    std::size_t same = 0, twice = 0;
    for (std::size_t i = 0; i < count; ++i) {
        same += bytes_without_sender(first[i]) == bytes_without_sender(originals[i]) ? 1 : 0;
        twice += bytes_of(first[i]) == bytes_of(second[i]) ? 1 : 0;
    }
    CHECK(same == count);
    CHECK(twice == count);
    CHECK(hive::event_text(originals[0]).size() > 1024);
}

TEST_CASE("recording: the work of a replay that begins again and again can be shared, and no result is taken for a "
          "second answer")
{
    constexpr std::size_t count = 10;
    const Swarm swarm;
    const auto file = (swarm.home() / "run.hive").string();
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    swarm.hivectl_done({"record", "source", "-o", file, "-n", std::to_string(count)});
    const auto replay = swarm.drone("replay", "replay", {"file=" + file, "pace=demand", "loop=on"});
    const auto first = swarm.drone("sleeper", "first"), second = swarm.drone("sleeper", "second");
    auto application = swarm.application();
    const auto collector = application.collect({{"first", "result"}, {"second", "result"}}, {.connection = wide});
    swarm.hivectl_done({"connect", "replay.tick", "first", "second", "--share"});
    take(*collector, 5 * count);
    CHECK(collector->counts().duplicates == 0);
    for (const char* worker : {"first", "second"})
        CHECK(at_inputs(application.status(worker), &hive::InputStatus::duplicates) == 0);
}

TEST_CASE("recording: a recorder that is killed leaves every event that it had taken")
{
    const Swarm swarm;
    const auto file = swarm.home() / "run.hive";
    const auto source = swarm.drone("ticker", "source", {"fps=200", "bytes=10000"});
    auto recorder = swarm.drone("record", "record", {"file=" + file.string()});
    auto application = swarm.application();
    application.connect({"source", ""}, {"record", ""}, wide);
    std::int64_t taken = 0;
    REQUIRE(eventually(
        [&] { return (taken = at_inputs(application.status("record"), &hive::InputStatus::processed)) >= 100; }));
    recorder.kill();
    Reader reader(file);
    CHECK(has(reader.problem(), "no end"));
    CHECK(reader.summary().ended == "");
    CHECK(contiguous_events(reader) >= taken);

    const auto info = swarm.hivectl({"replay", file.string(), "--info", "--json"});
    CHECK(info.exit_code == 8);
    CHECK(has(info.err, "no end"));
    CHECK(Json::parse(info.out).at("events") == reader.summary().events());
    const auto replay = swarm.drone("replay", "replay", {"file=" + file.string(), "pace=demand"});
    const auto collector = application.collect({{"replay", "tick"}});
    take(*collector, static_cast<std::size_t>(reader.summary().events()));
    CHECK(eventually(
        [&] { return has(application.status("replay").condition, "end of recording; the recording has no end"); }));
    CHECK(application.status("replay").last_exception.value().code == "malformed");
}

TEST_CASE(
    "recording: a full disk is reported within a second, delays no one else, and the file is complete up to there")
{
    const Swarm swarm;
    if (!possible(swarm.run({"/usr/bin/unshare", "-Urm", "/bin/true"}).exit_code == 0
                      ? ""
                      : "the right to mount a file system"))
        return;
    const auto disk = swarm.home() / "disk", copy = swarm.home() / "copy.hive";
    fs::create_directory(disk);
    const auto camera = swarm.drone("camera", "camera", {"fps=30"});
    const std::string script = "mount -t tmpfs -o size=8m small " + disk.string() + " && hive-record --set file="
                               + disk.string() + "/run.hive; cp " + disk.string() + "/run.hive " + copy.string()
                               + ".part && mv " + copy.string() + ".part " + copy.string();
    const char* path = std::getenv("PATH");
    const std::vector<std::string> environment{"HIVE_HOME=" + swarm.home().string(),
                                               "PATH=" + swarm.program("").string() + ":" + (path ? path : "/bin")};
    const Process recorder({"/usr/bin/unshare", "-Urm", "/bin/sh", "-c", script}, environment,
                           swarm.home() / "record.log");
    auto application = swarm.application();
    REQUIRE_MESSAGE(eventually(
                        [&] {
                            return fs::exists(swarm.home() / "record.sock")
                                   && value_of(application.status(std::vector<std::string>{"record"}).at(0).status);
                        },
                        10'000ms),
                    swarm.log("record"));

    const auto exceptions = application.exceptions({"record"});
    const auto other = application.collect({{"camera", "image"}});
    application.connect({"camera", ""}, {"record", ""}, wide);
    std::optional<hive::Event> exception;
    std::int64_t last = 0, gaps = 0, seen = 0;
    REQUIRE(eventually(
        [&] {
            if (const auto event = other->next(0ms)) {
                gaps += last > 0 && event->identity.sequence != last + 1 ? 1 : 0;
                last = event->identity.sequence;
                ++seen;
            }
            if (!exception)
                exception = exceptions->next(0ms);
            return exception && seen > 60;
        },
        10'000ms));
    CHECK(has(exception->header.at("text"), "disk full"));
    const auto full_file = (disk / "run.hive").string();
    CHECK(application.status("record").condition
          == "disk full: " + full_file + "; set file=" + (disk / "run-2.hive").string());
    CHECK(exception->header.at("text") == "disk full: " + full_file);
    CHECK(eventually([&] { return application.status("record").inputs.at(0).abandoned > 0; }));
    CHECK(application.status("record").state != hive::State::halted);
    CHECK(gaps == 0);
    application.stop("record");
    REQUIRE(eventually([&] { return fs::exists(copy); }));
    Reader reader(copy);
    const auto& summary = reader.summary();
    const auto said_after = exception->identity.captured_us - (summary.begun_us + summary.duration_us);
    MESSAGE(summary.events(), " events, ", lost_in(reader), " lost; said ", said_after / 1000,
            " ms after the last one that went in");
    CHECK(said_after < 1'000'000);
    CHECK(summary.ended == "disk full");
    CHECK(lost_in(reader) > 0);
    CHECK(contiguous_events(reader) == summary.events());
    CHECK(reader.problem() == "");
}

TEST_CASE("recording: a killed and restarted recorder continues in a new file, and the old file stays")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    const auto file = swarm.home() / "run.hive";
    auto application = swarm.application();
    {
        auto recorder = swarm.drone("record", "record", {"file=" + file.string(), "overwrite=on"});
        application.connect({"source", ""}, {"record", ""}, {.window = 8, .group = {}, .lease = {}});
        REQUIRE(eventually([&] { return recorded_in(file) > 20; }));
        recorder.signal(SIGKILL);
        recorder.wait(2000ms);
    }
    const auto kept = text_of(file);
    for (const char* name : {"run-2.hive", "run-3.hive"}) {
        CAPTURE(name);
        auto again = swarm.drone("record", "record");
        CHECK(application.get("record", {"file"}).at("file") == (swarm.home() / name).string());
        CHECK(eventually([&] { return recorded_in(swarm.home() / name) > 20; }));
        again.signal(SIGKILL);
        again.wait(2000ms);
    }
    CHECK(text_of(file) == kept);
}

TEST_CASE("recording: an engine starts a recorder that was killed with the words of its first start, and it goes on in "
          "a new file too")
{
    const Swarm swarm;
    const auto file = swarm.home() / "run.hive";
    for (const char* overwrite : {"overwrite=off", "overwrite=on"}) {
        CAPTURE(overwrite);
        const std::vector<std::string> words{"file=" + file.string(), overwrite};
        {
            const auto source = swarm.drone("ticker", "source", {"fps=100"});
            auto recorder = swarm.drone("record", "record", words);
            swarm.application().connect({"source", ""}, {"record", ""}, wide);
            REQUIRE(eventually([&] { return recorded_in(file) > 20; }));
            recorder.signal(SIGKILL);
            recorder.wait(2000ms);
        }
        const auto kept = text_of(file);
        for (const char* name : {"run-2.hive", "run-3.hive"}) {
            CAPTURE(name);
            auto again = swarm.drone("record", "record", words);
            CHECK(swarm.application().get("record", {"file"}).at("file") == (swarm.home() / name).string());
            again.signal(SIGKILL);
            again.wait(2000ms);
        }
        CHECK(text_of(file) == kept);
        {
            auto last = swarm.drone("record", "record", words);
            swarm.application().stop("record");
            last.wait(2000ms);
        }
        for (const char* name : {"run.hive", "run-2.hive", "run-3.hive", "run-4.hive"})
            CHECK(fs::remove(swarm.home() / name));
    }
}

TEST_CASE("recording: a joint set of another file that is aborted leaves the recording as it was, and one that holds "
          "ends it")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    for (const char* overwrite : {"overwrite=off", "overwrite=on"}) {
        CAPTURE(overwrite);
        const auto folder = swarm.home() / overwrite;
        fs::create_directories(folder / "other");
        const auto file = folder / "a.hive", other = folder / "b.hive";
        auto recorder = swarm.drone("record", "rec-1", {"file=" + file.string(), overwrite});
        auto silent = swarm.drone("record", "rec-2", {"file=" + (folder / "other" / "a.hive").string()});
        auto application = swarm.application();
        application.connect({"source", ""}, {"rec-1", ""}, wide);
        REQUIRE(eventually([&] { return recorded_in(file) > 20; }));
        silent.signal(SIGSTOP);
        auto setter = swarm.hivectl_running({"set", "rec-*", "file=b.hive", "--timeout", "2"}, "set");
        CHECK(eventually([&] { return fs::exists(other); }));
        CHECK(setter.wait(patient(10'000ms)).value_or(0) != 0);
        silent.kill();
        CHECK(application.get("rec-1", {"file"}).at("file") == file.string());
        CHECK(eventually([&] { return !fs::exists(other); }));
        const auto before = recorded_in(file);
        CHECK(before > 20);
        CHECK(eventually([&] { return recorded_in(file) > before + 20; }));

        application.set("rec-1", {{"file", "b.hive"}});
        CHECK(eventually([&] { return recorded_in(other) > 20; }));
        Reader reader(file);
        CHECK(reader.problem() == "");
        CHECK(reader.summary().ended == "another file was set");
        std::int64_t events = 0;
        while (reader.next())
            ++events;
        CHECK(events == reader.summary().events());
        application.stop("rec-1");
        recorder.wait(patient(5000ms));
    }
}

TEST_CASE("replay: another pace holds from the next event on, for which everybody is waited for then, and nothing is "
          "sent twice")
{
    constexpr std::size_t count = 4;
    const Swarm swarm;
    const auto file = (swarm.home() / "run.hive").string();
    {
        const auto source = swarm.drone("ticker", "source", {"fps=10"});
        swarm.hivectl_done({"record", "source", "-o", file, "-n", std::to_string(count)});
    }
    const auto replay = swarm.drone("replay", "replay", {"file=" + file, "speed=0.1"}, {"--halted"});
    const auto slow = swarm.drone("sleeper", "slow", {"work_ms=1800"});
    auto application = swarm.application();
    const auto quick = application.collect({{"replay", "tick"}});
    const auto results = application.collect({{"slow", "result"}}, {.connection = wide});
    application.connect({"replay", ""}, {"slow", ""});
    application.resume("replay");
    auto last = take(*quick, 2).back().identity.sequence;  // the second one waits for slow
    CHECK(application.status("replay").source_events == count);
    application.set("replay", {{"pace", "demand"}});  // the third one is prepared, and due in a second
    for (const auto& event : take(*quick, count - 2))
        CHECK(event.identity.sequence == std::exchange(last, event.identity.sequence) + 1);
    take(*results, count);
    CHECK_FALSE(quick->next(0ms));
    CHECK(edge_to(application.status("replay"), "slow.image").events.of(hive::Fate::skipped) == 0);
}

TEST_CASE("replay: the number of remaining events is that of the current loop")
{
    const Swarm swarm;
    const auto file = (swarm.home() / "run.hive").string();
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    swarm.hivectl_done({"record", "source", "-o", file, "-n", "5"});
    const auto replay = swarm.drone("replay", "replay", {"file=" + file});
    auto application = swarm.application();
    CHECK(application.status("replay").source_events == 5);
    application.set("replay", {{"loop", true}});
    CHECK(application.status("replay").source_events == 0);
    application.set("replay", {{"loop", false}});
    CHECK(application.status("replay").source_events == 5);
}

TEST_CASE("recording: at the end of its source a recording is complete, and what comes later is in the next one")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=5"});
    const auto file = swarm.home() / "run.hive", next = swarm.home() / "run-2.hive";
    const auto recorder = swarm.drone("record", "recorder", {"file=" + file.string()});
    auto application = swarm.application();
    const auto comes_to_say = [&](const std::string& text) {
        const bool said = eventually([&] { return has(application.status("recorder").condition, text); }, 10'000ms);
        CHECK_MESSAGE(said, text, " and not ", application.status("recorder").condition);
    };
    const auto events_in = [](const fs::path& path) {
        Reader reader(path);
        CHECK(reader.summary().ended == "end of source");
        return contiguous_events(reader);
    };
    application.connect({"source", "tick"}, {"recorder", "events"}, wide);
    comes_to_say("ended: end of source; " + file.string() + " is complete");
    CHECK(events_in(file) == 5);
    application.set("source", {{"count", 8}});
    comes_to_say("ended: end of source; " + next.string() + " is complete");
    CHECK(events_in(file) == 5);
    CHECK(events_in(next) == 3);
}

TEST_CASE("recording: a set reaches no file outside of the folder that the recorder was started for")
{
    const Swarm swarm;
    const auto own = swarm.home() / "own", outside = swarm.home() / "outside.hive";
    fs::create_directory(own);
    fs::create_symlink(outside, own / "link.hive");
    const auto recorder = swarm.drone("record", "record", {"file=" + (own / "run.hive").string()});
    for (const auto& path : {outside.string(), std::string("../outside.hive"), (own / "../outside.hive").string(),
                             std::string("link.hive"), std::string(".profile")}) {
        CAPTURE(path);
        const auto set = swarm.hivectl({"set", "record", "file=" + path, "overwrite=on"});
        CHECK_MESSAGE(set.exit_code == 5, set.err);
    }
    CHECK_FALSE(fs::exists(outside));
    CHECK(swarm.hivectl({"set", "record", "file=next.hive"}).exit_code == 0);
    CHECK(fs::exists(own / "next.hive"));
    CHECK(swarm.hivectl({"set", "record", "file=" + (own / "last.hive").string()}).exit_code == 0);
    for (const auto& file : {own / "last.hive", swarm.home() / "record.state"})
        CHECK(fs::status(file).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("hivectl record: ends as requested, prints the content of the file, and exits with the losses")
{
    const Swarm swarm;
    const auto left = swarm.drone("ticker", "left", {"fps=40"}), right = swarm.drone("ticker", "right", {"fps=40"});
    const auto file = (swarm.home() / "run.hive").string();
    const auto done = Json::parse(swarm.hivectl_done({"record", "left", "right", "-o", file, "-n", "50", "--json"}));
    CHECK(done.at("events") == 50);
    CHECK(done.at("outputs") == 2);
    CHECK(done.at("ended") == "count reached");
    CHECK(done.at("lost").empty());
    CHECK(swarm.hivectl({"record", "left", "-o", file, "-n", "1"}).exit_code == 1);  // it is there
    CHECK(Reader(file).summary().events() == 50);
    CHECK(has(swarm.hivectl_done({"replay", file, "--info"}), "left-tick"));
    CHECK(has(swarm.hivectl_done({"record", "left", "-o", (swarm.home() / "one.hive").string(), "-n", "1"}),
              ": 1 event of 1 output in "));

    CHECK(swarm.hivectl_done({"replay", file, "--pace", "demand", "--halted"}) == "replay\n");
    auto application = swarm.application();
    CHECK(application.describe("replay").outputs.size() == 2);
    CHECK(application.status("replay").state == hive::State::halted);

    const auto fast = swarm.drone("ticker", "fast", {"fps=20000"});
    const auto lossy = swarm.hivectl({"record", "fast", "-o", file, "--overwrite", "--for", "0.5", "--window", "1"});
    CHECK(lossy.exit_code == 8);
    CHECK(has(lossy.err, "skipped by the sender"));
    CHECK(lost_in(Reader(file)) > 0);
    CHECK(Reader(file).summary().ended == "time over");

    const auto small = (swarm.home() / "small.hive").string();
    const auto full = swarm.run({"/bin/sh", "-c",
                                 "ulimit -f 200; exec " + swarm.program("hivectl").string() + " record fast -o " + small
                                     + " -n 100000 --timeout 60"});
    CHECK_MESSAGE(full.exit_code == 8, full.err);
    CHECK_MESSAGE(has(full.err, "earlier events are in the file"), full.err);
    CHECK_FALSE(has(full.out, "nothing lost"));
    CHECK(Reader(small).summary().events() > 0);
}

TEST_CASE("hivectl record: Ctrl-C is its proper end, and headers alone are replayed to those who receive headers alone")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=40"});
    const auto file = swarm.home() / "run.hive";
    auto application = swarm.application();
    const auto receiver = application.collect({{"source", "tick"}});  // a source makes no bodies without a receiver
    auto running = swarm.hivectl_running({"record", "source", "-o", file.string(), "--notify"}, "recording");
    REQUIRE(eventually([&] { return recorded_in(file) > 10; }));
    running.signal(SIGINT);
    REQUIRE(running.wait(patient(3000ms)) == 0);
    const Reader reader(file);
    CHECK(reader.problem() == "");
    CHECK(reader.summary().ended == "stopped");
    CHECK(reader.summary().tracks.at(0).without_body == reader.summary().events());
    CHECK(reader.summary().tracks.at(0).bytes == 0);

    for (const std::string pace : {"pace=real", "pace=demand"}) {
        CAPTURE(pace);
        const auto alone = swarm.drone("replay", "alone", {"file=" + file.string(), pace});
        const auto watching = application.collect(
            {{"alone", "tick"}}, {.connection = {.delivery = hive::Delivery::notification, .group = {}, .lease = {}}});
        CHECK(watching->next(patient(2000ms)));
    }
    const auto replay = swarm.drone("replay", "replay", {"file=" + file.string(), "speed=1000"});
    application.halt("replay");
    const auto watching =
        application.collect({{"replay", "tick"}}, {.connection = {.transfer = hive::Transfer::streaming,
                                                                  .delivery = hive::Delivery::notification,
                                                                  .group = {},
                                                                  .lease = {}}});
    const auto receiving = application.collect({{"replay", "tick"}});
    application.resume("replay");
    const auto events = take(*watching, static_cast<std::size_t>(reader.summary().events()));
    CHECK(events.front().size == 1000);
    CHECK(eventually([&] {
        return has(application.status("replay").condition,
                   "end of recording; without a body, so for no receiver of bodies: ");
    }));
    CHECK_FALSE(receiving->next(0ms));
}
