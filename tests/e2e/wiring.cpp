// Connections: refused with a reason if impossible, restored silently after an end was killed, forgotten by stop.
#include "measure.hpp"
#include "status_sums.hpp"

#include <hive/event/home.hpp>

#include <doctest/doctest.h>
#include <raw_peer.hpp>

#include <algorithm>
#include <thread>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

std::int64_t processed(hive::Application& application, const std::string& drone)
{
    return at_inputs(application.status(drone), &hive::InputStatus::processed);
}

/// From the start of a program until the drone at the other end has processed events again.
Milliseconds back_after(Clock::time_point begin, hive::Application& application)
{
    const auto before = processed(application, "worker");
    REQUIRE(eventually([&] { return processed(application, "worker") > before + 1; }, 10'000ms));
    return std::chrono::duration_cast<Milliseconds>(Clock::now() - begin);
}

}  // namespace

TEST_CASE("connect: types that do not fit are refused with exit code 6 and both types named")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source");
    const auto face = swarm.drone("face", "face");
    const auto refused = swarm.hivectl({"connect", "source", "face"});
    CHECK(refused.exit_code == 6);
    CHECK(has(refused.err, "application/octet-stream"));
    CHECK(has(refused.err, "image/jpeg"));
    for (const std::string name : {"connections", "edges"})  // its older name
        CHECK(swarm.hivectl_done({name, "--json"}) == "[]\n");
}

TEST_CASE("connect: an unknown drone is exit code 3 with the nearest name, an unknown port with the nearest port")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "camera-left");
    const auto worker = swarm.drone("sleeper", "worker");
    const auto no_sender = swarm.hivectl({"connect", "camera-lift", "worker"});
    CHECK(no_sender.exit_code == 3);
    CHECK(has(no_sender.err, "camera-left"));
    const auto no_receiver = swarm.hivectl({"connect", "camera-left", "wroker"});
    CHECK(no_receiver.exit_code == 3);
    CHECK(has(no_receiver.err, "did you mean worker"));
    const auto no_port = swarm.hivectl({"connect", "camera-left.tock", "worker"});
    CHECK(no_port.exit_code == 3);
    CHECK(has(no_port.err, "did you mean tick"));
}

TEST_CASE("connect: a receiver that cuts off who asks, since it took it for dead, is asked again")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source");
    const auto worker = swarm.drone("sleeper", "worker");
    const Json interface = raw::Peer::meet(swarm.home() / "worker.sock").ask(raw::describe).at("result");
    const hive::event::NameClaim claim(hive::event::Home(swarm.home()), "busy");
    raw::Listener listener(swarm.home() / "busy.sock");
    std::thread busy([&] {
        const auto meet = [&] {
            auto asker = listener.accept();
            asker->send(raw::hello_packet("busy", "sleeper"));
            return asker;
        };
        const auto answer = [](raw::Peer& asker, int type, const Json& result) {
            const Json id = asker.next_of(type)->json().at("id");
            asker.send(raw::packet(raw::confirmation, 0, Json{{"id", id}, {"result", result}}.dump()));
        };
        auto asker = meet();
        answer(*asker, raw::describe, interface);
        static_cast<void>(asker->next_of(raw::connect));
        asker.reset();
        static_cast<void>(listener.accept());
        asker = meet();
        answer(*asker, raw::connect, Json::object());
    });
    auto application = swarm.application();
    CHECK_NOTHROW(application.connect({"source", "tick"}, {"busy", "image"}));
    busy.join();
}

TEST_CASE("connect: a drone that keeps state is refused in a group with exit code 5, and taken alone")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    const auto counter = swarm.drone("counter", "counter");
    const auto shared = swarm.hivectl({"connect", "source", "counter", "--share"});
    CHECK(shared.exit_code == 5);
    CHECK(has(shared.err, "keeps state"));
    CHECK(swarm.hivectl_done({"connect", "source", "counter"}) == "source.tick -> counter.tick\n");
    const auto line = Json::parse(swarm.hivectl_done({"results", "counter", "-n", "1"}));
    CHECK(line.at("header").at("count") >= 1);
}

TEST_CASE("connect: a group with --first-frame is refused, and nothing is connected")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    const auto worker = swarm.drone("sleeper", "worker");
    for (const auto& sharing : {std::vector<std::string>{"--share"}, {"--group", "workers"}}) {
        std::vector<std::string> words{"connect", "source", "worker", "--first-frame"};
        words.insert(words.end(), sharing.begin(), sharing.end());
        const auto refused = swarm.hivectl(words);
        CHECK(refused.exit_code == 2);
        CHECK(has(refused.err, "--first-frame"));
    }
    auto application = swarm.application();
    CHECK_THROWS_AS(
        application.connect({"source", ""}, {"worker", ""}, {.group = "workers", .first_frame = true, .lease = {}}),
        hive::Error);
    CHECK(application.status("worker").inputs.empty());
}

TEST_CASE(
    "collect: every event of a stream is received or counted as dropped by the collector that did not take it in time")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=0.1", "count=3000", "bytes=10"});
    auto application = swarm.application();
    const auto collector = application.collect(
        {{"source", "tick"}}, {.connection = {.transfer = hive::Transfer::streaming, .group = {}, .lease = {}}});
    application.set("source", {{"fps", 5000}});
    REQUIRE(eventually([&] { return application.status("source").condition == "end of source"; }, 10'000ms));
    const auto delivered = [&] {
        return application.status("source").outputs.at(0).edges.at(0).events.of(hive::Fate::acknowledged);
    };
    CHECK(eventually([&] {
        while (collector->next(20ms)) {
        }
        const auto all = delivered();
        return collector->counts().received + collector->counts().dropped == all;
    }));
    const auto counts = collector->counts();
    MESSAGE(delivered(), " delivered, ", counts.received, " received, ", counts.dropped, " dropped");
    CHECK(counts.received < delivered());
    CHECK(counts.received + counts.dropped == delivered());
}

TEST_CASE("restart: a source that was killed and started again gives events again, with no command")
{
    const Swarm swarm;
    auto source = swarm.drone("ticker", "source", {"fps=100"});
    const auto worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"set", "source", "bytes=77"});
    swarm.hivectl_done({"connect", "source", "worker"});
    auto application = swarm.application();
    for (int round = 0; round < 3; ++round) {
        REQUIRE(eventually([&] { return processed(application, "worker") > 0; }));
        source.kill();
        const auto begin = Clock::now();
        source = swarm.drone("ticker", "source");
        const auto took = back_after(begin, application);
        MESSAGE("events again after ", took.count(), " ms");
        CHECK(took <= patient(5000ms));
    }
    CHECK(application.get("source", {"bytes", "fps"}) == Json{{"bytes", 77}, {"fps", 100.0}});
}

TEST_CASE("restart: a receiver that was killed and started again has its connections and parameters again, and stop "
          "forgets them")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    auto worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"set", "worker", "work_ms=3"});
    swarm.hivectl_done({"connect", "source", "worker", "--window", "2"});
    auto application = swarm.application();
    for (int round = 0; round < 3; ++round) {
        REQUIRE(eventually([&] { return processed(application, "worker") > 0; }));
        worker.kill();
        const auto begin = Clock::now();
        worker = swarm.drone("sleeper", "worker");
        const auto took = back_after(begin, application);
        MESSAGE("events again after ", took.count(), " ms");
        CHECK(took <= patient(5000ms));
    }
    CHECK(application.get("worker", {"work_ms"}) == Json{{"work_ms", 3}});
    CHECK(application.status("worker").inputs.at(0).options.window == 2);

    swarm.hivectl_done({"stop", "worker"});
    worker = swarm.drone("sleeper", "worker");
    CHECK(application.get("worker", {"work_ms"}) == Json{{"work_ms", 0}});
    CHECK(application.status("worker").inputs.empty());
    CHECK(Json::parse(swarm.hivectl_done({"connections", "--json"})).at(0).at("state") == "gone");
}

TEST_CASE("stop: a drone that crashed is forgotten, by its name, a glob or --all, and one that was never there is exit "
          "code 3")
{
    const Swarm swarm;
    const auto crash = [&](const std::string& name) {
        auto drone = swarm.drone("ticker", name, {"bytes=77"});
        drone.kill();
    };
    const auto remembers = [&](const std::string& name) {
        return std::filesystem::exists(swarm.home() / (name + ".state"));
    };
    for (const auto& words : {std::vector<std::string>{"stop", "left-1"}, {"stop", "left-*"}, {"stop", "--all"}}) {
        CAPTURE(words.back());
        crash("left-1");
        REQUIRE(remembers("left-1"));
        const auto stopped = swarm.hivectl(words);
        CHECK(stopped.exit_code == 0);
        CHECK(stopped.out.empty());
        CHECK(has(stopped.err, "left-1 was not running; its saved state was discarded"));
        CHECK_FALSE(remembers("left-1"));
    }
    crash("left-1");
    CHECK(swarm.hivectl_done({"stop", "left-1", "--json"}) == "{\"forgotten\":\"left-1\"}\n");
    const auto again = swarm.drone("ticker", "left-1");
    CHECK(swarm.application().get("left-1", {"bytes"}) != Json{{"bytes", 77}});
    const auto never = swarm.hivectl({"stop", "quite-another"});
    CHECK(never.exit_code == 3);
    CHECK(has(never.err, "see what runs: hivectl ps"));
    CHECK_FALSE(has(never.err, "hivectl start"));
}

TEST_CASE("restart: a source killed while nobody starts it is waited for, and said to be waited for")
{
    const Swarm swarm;
    auto source = swarm.drone("ticker", "source", {"fps=100"});
    const auto worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "source", "worker"});
    source.kill();
    auto application = swarm.application();
    const auto connected = [&] { return application.status("worker").inputs.at(0).connected; };
    // A dead peer on one machine is detected within 50 ms.
    const auto begin = Clock::now();
    REQUIRE(eventually([&] { return !connected(); }));
    CHECK(Clock::now() - begin <= patient(2000ms));
    const auto edges = Json::parse(swarm.hivectl_done({"connections", "--json"}));
    REQUIRE(edges.size() == 1);
    CHECK(edges[0].at("state") == "waiting");
    CHECK_FALSE(edges[0].at("error").get<std::string>().empty());
}

TEST_CASE("chain of custody: what a source on demand gave while nobody collected is not lost, and the results begin "
          "with the first")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=200"});
    const auto worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""}, {.window = 4, .group = {}, .lease = {}});
    REQUIRE(eventually([&] { return application.status("worker").outputs.at(0).produced > 0; }));
    const auto collector = application.collect({{"worker", "result"}}, {.ordered = true});
    for (int i = 1; i <= 200; ++i) {
        const auto event = collector->next(patient(5000ms));
        REQUIRE(event);
        REQUIRE(event->identity.sequence == i);
    }
    CHECK_FALSE(collector->next(200ms));
    CHECK(collector->counts().missing == 0);
    CHECK(collector->counts().duplicates == 0);
}

TEST_CASE(
    "notify: a watcher whose results nobody collects goes on being told of a source on demand, and holds up nobody")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=200"});
    const auto worker = swarm.drone("sleeper", "worker", {"work_ms=1"}), watcher = swarm.drone("sleeper", "watcher");
    auto application = swarm.application();
    const auto collector = application.collect({{"worker", "result"}}, {.ordered = true});
    swarm.hivectl_done({"connect", "source", "watcher", "--notify"});
    swarm.hivectl_done({"connect", "source", "worker"});
    for (int i = 1; i <= 200; ++i)
        REQUIRE(collector->next(patient(5000ms)));
    CHECK(processed(application, "watcher") > 10);
    const auto status = application.status("watcher");
    CHECK(at_inputs(status, &hive::InputStatus::abandoned) == 0);
    CHECK(connected_edges(status.outputs.at(0)) == 0);
}

TEST_CASE("disconnect: a source on demand that waits for a killed receiver says so, and goes on when that is forgotten")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"});
    auto lost = swarm.drone("sleeper", "lost");
    const auto worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    const auto collector = application.collect({{"worker", "result"}, {"lost", "result"}});
    for (const char* receiver : {"lost", "worker"})
        application.connect({"source", "tick"}, {receiver, "image"});
    REQUIRE(collector->next(patient(5000ms)));
    lost.kill();
    swarm.hivectl_done({"stop", "lost"}, 5000ms);  // it will not restart by itself
    while (collector->next(300ms)) {
    }
    std::string ps;  // a pause of less than a second is not a stall
    CHECK_MESSAGE(eventually([&] {
                      ps = swarm.hivectl_done({"ps", "source"});
                      return has(ps, "it waits for a receiver that was cut off, or has not come yet (lost.image)");
                  }),
                  ps);
    const auto edges = Json::parse(swarm.hivectl_done({"connections", "source", "--json"}));
    CHECK(std::ranges::any_of(edges, [](const Json& edge) {
        return edge.at("to") == "lost.image" && edge.at("state") == "place_kept" && edge.at("why") == "place_kept";
    }));
    CHECK(swarm.hivectl_done({"disconnect", "source", "lost"}) == "source -x- lost\n");
    CHECK(collector->next(patient(5000ms)));
    const auto again = swarm.hivectl({"disconnect", "source", "lost"});
    CHECK(again.exit_code == 3);
    CHECK(has(again.err, "lost is not running, and source"));
}

TEST_CASE("status: 140 receivers of one output are 140 rows with counts")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=20"});
    auto application = swarm.application();
    std::vector<std::unique_ptr<hive::Application>> receivers;
    std::vector<std::unique_ptr<hive::Collector>> collectors;
    for (int i = 0; i < 140; ++i) {
        receivers.push_back(std::make_unique<hive::Application>(hive::Application::Options{
            .name = "receiver-with-a-rather-long-name-" + std::to_string(i), .home = swarm.home()}));
        collectors.push_back(receivers.back()->collect({{"source", "tick"}}));
    }
    const auto status = application.status("source");
    CHECK(status.outputs.at(0).edges.size() == 140);
    const auto rows = Json::parse(swarm.hivectl_done({"connections", "--json", "--timeout", "10"}));
    CHECK(rows.size() == 140);
    CHECK(std::ranges::all_of(rows, [](const Json& row) { return row.at("came").is_number(); }));
}

TEST_CASE("collect: whoever leaves with lossless events that it has not taken leaves at once, and the source goes on")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"});
    auto application = swarm.application();
    std::vector<Clock::duration> took;
    for (int round = 0; round < 5; ++round) {
        auto leaving =
            std::make_unique<hive::Application>(hive::Application::Options{.name = "leaving", .home = swarm.home()});
        auto collector = leaving->collect({{"source", "tick"}});
        REQUIRE(collector->next(patient(5000ms)));
        REQUIRE(
            eventually([&] { return edge_to(application.status("source"), leaving->name()).events.in_flight() > 10; }));
        const auto begin = Clock::now();
        collector.reset();
        leaving.reset();
        took.push_back(Clock::now() - begin);
        CHECK(application.collect({{"source", "tick"}})->next(patient(5000ms)));
    }
    CHECK(std::ranges::min(took) < stated(400ms));
}

TEST_CASE("collect: an event that is kept of a collector that is gone does not hold up another one of the same output")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source");
    auto application = swarm.application();
    hive::CollectOptions one_at_once;
    one_at_once.connection.window = 1;
    const auto kept = application.collect({{"source", "tick"}}, one_at_once)->next(patient(5000ms));
    REQUIRE(kept);
    CHECK(application.collect({{"source", "tick"}}, one_at_once)->next(patient(5000ms)));
}
