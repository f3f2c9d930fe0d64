// Two drones of one name: what a peer says of itself ends no other's connection and takes no other's place.
#include "taking.hpp"

#include <raw_peer.hpp>

using namespace hive::test;
using hive::Json;

namespace {

/// Says hello as a drone of this name that was started later than all before it.
raw::Peer drone_called(const std::string& name, const Swarm& swarm)
{
    auto peer = raw::Peer::dial(swarm.home() / "source.sock");
    peer.send(raw::hello_packet(name, "worker"));
    REQUIRE(peer.next());
    return peer;
}

void ask_to_register(raw::Peer& peer, int window)
{
    const Json header{
        {"id", 1}, {"epoch", 1}, {"output", "tick"}, {"receiver", "twin.image"}, {"options", {{"window", window}}}};
    peer.send(raw::packet(raw::register_, 1, header.dump()));
}

std::int64_t next_sequence(raw::Peer& peer)
{
    const auto event = peer.next_of(raw::event);
    return event ? event->json().at("seq").get<std::int64_t>() : 0;
}

}  // namespace

TEST_CASE("names: two drones of one name each get every event, with a row and counts of their own")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"});
    auto first = drone_called("twin", swarm);
    ask_to_register(first, 3);
    REQUIRE(first.next_of(raw::confirmation));
    auto second = drone_called("twin", swarm);
    ask_to_register(second, 3);
    CHECK_FALSE(second.next_of(raw::confirmation, 100ms));  // is the first one its earlier run? It has not answered yet
    for (std::int64_t i = 1; i <= 3; ++i)
        CHECK(next_sequence(first) == i);
    CHECK_FALSE(first.next(200ms));  // it answers the ping
    REQUIRE(second.next_of(raw::confirmation));
    first.send(raw::packet(raw::request, 1, R"({"epoch":1,"id":6,"worked":3,"done":3})"));
    for (std::int64_t i = 4; i <= 6; ++i) {
        CHECK(next_sequence(first) == i);
        CHECK(next_sequence(second) == i);
    }
    auto application = swarm.application();
    const auto rows = receivers(application, "source");
    REQUIRE(rows.size() == 2);
    for (const auto& row : rows) {
        CHECK(row.at("receiver") == "twin.image");
        CHECK(row.at("connected"));
    }
    CHECK(number_in(rows[0], "came") + number_in(rows[1], "came") >= 9);
    CHECK(swarm.log("source").find("two drones are called twin") != std::string::npos);
}

TEST_CASE("names: a restarted drone takes the place of its earlier run once that is silent, and lacks nothing")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"});
    auto earlier = drone_called("twin", swarm);
    ask_to_register(earlier, 2);
    CHECK(next_sequence(earlier) == 1);
    CHECK(next_sequence(earlier) == 2);
    earlier.send(raw::packet(raw::request, 1, R"({"epoch":1,"id":2,"worked":1,"done":1})"));
    auto later = drone_called("twin", swarm);  // nothing comes from the earlier one any more, as after a power cut
    ask_to_register(later, 2);
    CHECK(next_sequence(later) == 2);
    CHECK(next_sequence(later) == 3);
    auto application = swarm.application();
    CHECK(receivers(application, "source").size() == 1);
}

TEST_CASE("names: hellos under the name of a drone, again and again, take nothing from it")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=300"});
    const auto twin = swarm.drone("sleeper", "twin", {"work_ms=5"});
    auto application = swarm.application();
    auto results = application.collect({{"twin", "result"}});
    application.connect({"source", "tick"}, {"twin", "image"});
    Sequences got;
    for (std::int64_t i = 1; i <= 300; ++i) {
        auto liar = drone_called("twin", swarm);
        for (const auto sequence : take(*results, 1))
            got.push_back(sequence);
    }
    CHECK_MESSAGE(got == one_to(300), listed(got));
    CHECK(total(application, "twin", "received") == 300);
}

TEST_CASE("disconnect: a receiver that is there and asks for nothing is let go by its sender, and is told")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"});
    const auto worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    const auto results = swarm.hivectl_running({"results", "worker"}, "results");
    REQUIRE(eventually([&] { return receivers(application, "worker").size() == 1; }));
    application.connect({"source", "tick"}, {"worker", "image"});
    REQUIRE(eventually([&] { return total(application, "worker", "processed") > 10; }));
    auto idle = drone_called("idle", swarm);
    const Json header{{"epoch", 1}, {"output", "tick"}, {"receiver", "idle.image"}, {"options", Json::object()}};
    const auto answer = idle.ask(raw::register_, header, 1);
    REQUIRE_MESSAGE(raw::error_of(answer) == "", answer.dump());
    const auto stands = [&] {
        const auto before = total(application, "worker", "processed");
        idle.next(300ms);
        return total(application, "worker", "processed") == before;
    };
    REQUIRE(eventually(stands));
    swarm.hivectl_done({"disconnect", "source", "idle"});
    const auto told = idle.next_of(raw::end, 1000ms);
    REQUIRE(told);
    CHECK(told->json().at("disconnected") == true);
    const auto processed = total(application, "worker", "processed");
    CHECK(eventually([&] { return total(application, "worker", "processed") > processed + 10; }));
    CHECK(receivers(application, "source").size() == 1);
}

TEST_CASE("disconnect: a receiver whose registration its sender ended says why, and comes back when it is told to")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50"});
    const auto worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    application.connect({"source", "tick"}, {"worker", "image"});
    auto results = swarm.hivectl_running({"results", "source"}, "results");
    REQUIRE(eventually([&] { return receivers(application, "source").size() == 2; }));
    auto peer = raw::Peer::meet(swarm.home() / "source.sock");
    for (const auto& row : receivers(application, "source"))
        CHECK(raw::error_of(peer.ask(raw::forget, {{"receiver", row.at("receiver")}})) == "");
    CHECK(receivers(application, "source").empty());
    CHECK(eventually([&] { return says(application, "worker", "refused"); }));
    CHECK(status_of(application, "worker").dump().find("was disconnected") != std::string::npos);
    CHECK(results.wait(5000ms) == 8);
    CHECK_MESSAGE(swarm.log("results").find("was disconnected") != std::string::npos, swarm.log("results"));
    application.connect({"source", "tick"}, {"worker", "image"});
    const auto processed = total(application, "worker", "processed");
    CHECK(eventually([&] { return total(application, "worker", "processed") > processed; }));
}
