// In order, and complete: whoever was slow, threw or was asked twice, an ordered collector loses no result and waits
// for none that cannot come.
#include "taking.hpp"

#include <hive/recording/reader.hpp>

#include <hive/event_text.hpp>

#include <csignal>
#include <fstream>

using namespace hive::test;
using hive::Json;

namespace {

namespace fs = std::filesystem;

/// What a recording has, one line for each event in its order: which output, which sequence, which body.
std::vector<std::string> events_in(const fs::path& file)
{
    hive::recording::Reader reader(file);
    std::vector<std::string> lines;
    while (const auto record = reader.next()) {
        const auto event = hive::event_from_text(reader.text(*record));
        std::vector<std::byte> body(record->prefix.body_size);
        reader.body(*record, body);
        const auto sum = std::hash<std::string_view>()({reinterpret_cast<const char*>(body.data()), body.size()});
        lines.push_back(event.identity.source + " " + std::to_string(event.identity.sequence) + " "
                        + event.header.dump() + " " + std::to_string(sum));
    }
    return lines;
}

/// Replays a recording on demand into another one.
/// @param meanwhile  is done with the recorder once the replay runs
std::vector<std::string> recorded_again(
    const Swarm& swarm, const fs::path& file, const fs::path& copy,
    const std::function<void(Process&)>& meanwhile = [](Process&) {})
{
    const auto count = events_in(file).size();
    swarm.hivectl_done({"replay", file.string(), "--pace", "demand", "--halted"});
    auto recorder = swarm.hivectl_running({"record", "replay", "-o", copy.string(), "-n", std::to_string(count)},
                                          "recorder-of-" + copy.stem().string());
    auto application = swarm.application();
    const auto both = [&] {
        const auto status = status_of(application, "replay");
        return std::ranges::all_of(status.at("outputs"), [](const Json& output) {
            return output.at("name") == "exceptions" || !registered(output).empty();
        });
    };
    REQUIRE(eventually(both));
    application.resume("replay");
    meanwhile(recorder);
    REQUIRE(recorder.wait(patient(10'000ms)) == 0);
    application.stop("replay");
    return events_in(copy);
}

/// A folder with copies of one picture of the camera, of which the third is cut short.
fs::path folder_with_a_damaged_picture(const Swarm& swarm)
{
    const auto folder = swarm.home() / "pictures", whole = swarm.home() / "whole.jpg";
    fs::create_directory(folder);
    const auto camera = swarm.drone("camera", "photographer", {"noise=0"});
    swarm.hivectl_done({"snap", "photographer", whole.string()});
    const auto picture = text_of(whole);
    for (int i = 1; i <= 6; ++i)
        std::ofstream(folder / (std::to_string(i) + ".jpg"), std::ios::binary)
            << (i == 3 ? picture.substr(0, picture.size() / 2) + "\xff\xd9" : picture);
    return folder;
}

}  // namespace

TEST_CASE("ordered: the first result of a group may be the slowest")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=10"});
    const auto slow = swarm.drone("sleeper", "slow", {"work_ms=2700"}), fast = swarm.drone("sleeper", "fast");
    auto application = swarm.application();
    const auto collector = application.collect({{"slow", "result"}, {"fast", "result"}}, in_order);
    for (const char* worker : {"slow", "fast"})
        application.connect({"source", "tick"}, {worker, "image"}, member_of("workers"));
    CHECK(listed(take(*collector, 10)) == listed(one_to(10)));
    CHECK(collector->counts().missing == 0);
}

TEST_CASE("ordered: what an earlier stage threw on is failed at once, and nothing waits for it")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=30"});
    const auto first = swarm.drone("sleeper", "first", {"throw_at=20", "work_ms=20"}),
               second = swarm.drone("sleeper", "second");
    auto application = swarm.application();
    application.connect({"first", "result"}, {"second", "image"});  // before, so that it hears of both from the start
    const auto collector = application.collect({{"second", "result"}}, in_order);
    application.connect({"source", "tick"}, {"first", "image"});
    auto expected = one_to(30);
    std::erase(expected, 20);
    CHECK(listed(take(*collector, 30)) == listed(expected));  // to the end: exceptions come another way than results
    CHECK(collector->counts().failed == 1);
    CHECK(collector->counts().missing == 0);
}

TEST_CASE("ordered: the end of a chain that is longer than an event can go says so, and lives on")
{
    const Swarm swarm;
    constexpr int stages = 16;
    std::vector<Process> drones;
    drones.push_back(swarm.drone("ticker", "s0", {"pace=demand", "count=3"}));
    for (int i = 1; i <= stages; ++i)
        drones.push_back(swarm.drone("sleeper", "s" + std::to_string(i)));
    auto application = swarm.application();
    const auto exceptions = application.exceptions({"s16"});
    for (int i = stages; i >= 1; --i)
        application.connect({"s" + std::to_string(i - 1), ""}, {"s" + std::to_string(i), "image"});
    for (int i = 0; i < 3; ++i) {
        const auto exception = exceptions->next(patient(5000ms));
        REQUIRE(exception);
        CHECK_MESSAGE(has(exception->header.at("text"), "this event has gone through 16"), exception->header.dump());
    }
    CHECK(application.status("s16").pid == drones.back().pid());
}

TEST_CASE("ordered: a damaged picture in a folder is failed at once, and its exception says which it was")
{
    const Swarm swarm;
    const auto folder = folder_with_a_damaged_picture(swarm);
    const auto face = swarm.drone("face", "face");
    const auto camera =
        swarm.drone("camera", "camera", {"source=" + folder.string(), "width=320", "pace=demand", "loop=off"});
    auto application = swarm.application();
    application.halt("camera");
    application.connect({"camera", "image"}, {"face", "image"});
    const auto exceptions = application.exceptions({"camera"});
    const auto collector = application.collect({{"face", "faces"}}, in_order);
    application.resume("camera");
    CHECK(listed(take(*collector, 6)) == "1 2 4 5 6");
    CHECK(collector->counts().failed == 1);
    CHECK(collector->counts().missing == 0);
    const auto exception = exceptions->next(patient(1000ms));
    REQUIRE(exception);
    CHECK(exception->identity.source == "camera");
    CHECK(exception->identity.sequence == 3);
}

TEST_CASE("ordered: a replay of two outputs on demand gives the same events in the same order each time")
{
    const Swarm swarm;
    const auto large = swarm.drone("ticker", "large", {"pace=demand", "bytes=300000"}),
               small = swarm.drone("ticker", "small", {"pace=demand", "bytes=100"});
    const auto file = swarm.home() / "run.hive";
    swarm.hivectl_done({"record", "large", "small", "-o", file.string(), "-n", "100"});
    const auto original = events_in(file);
    const auto once = recorded_again(swarm, file, swarm.home() / "once.hive"),
               twice = recorded_again(swarm, file, swarm.home() / "twice.hive");
    CHECK((once == twice));
    CHECK((once == original));
}

TEST_CASE("ordered: a replay of three outputs to a recorder that stands still for a while keeps their order")
{
    const Swarm swarm;
    // Bodies as large as go through the socket, which is full when its reader stands still.
    const auto large = swarm.drone("ticker", "large", {"pace=demand", "bytes=4000"}),
               other = swarm.drone("ticker", "other", {"pace=demand", "bytes=4000"}),
               small = swarm.drone("ticker", "small", {"pace=demand", "bytes=100"});
    const auto file = swarm.home() / "run.hive";
    swarm.hivectl_done({"record", "large", "other", "small", "-o", file.string(), "-n", "2000"});
    const auto again = recorded_again(swarm, file, swarm.home() / "again.hive", [](Process& recorder) {
        recorder.signal(SIGSTOP);
        std::this_thread::sleep_for(300ms);
        recorder.signal(SIGCONT);
    });
    CHECK((again == events_in(file)));
}

TEST_CASE("ordered: a recording that is replayed again and again goes on being taken by a drone that keeps state")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    const auto boxes = swarm.drone("fork", "boxes"), track = swarm.drone("track", "track");
    const auto file = (swarm.home() / "run.hive").string();
    auto application = swarm.application();
    application.connect({"source", "tick"}, {"boxes", "in"});
    swarm.hivectl_done({"record", "boxes.left", "-o", file, "-n", "20"});
    const auto replay = swarm.drone("replay", "replay", {"file=" + file, "pace=demand", "loop=on"});
    const auto collector = application.collect({{"track", "tracks"}});
    application.connect({"replay", "left"}, {"track", "boxes"});
    CHECK(take(*collector, 60, 2000ms).size() == 60);
    CHECK(total(application, "track", "abandoned") == 0);
}
