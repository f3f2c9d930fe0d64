// Tests of joining both ends' counts, of rates between two looks, and of the reasons in plain words.
#include "words/activity.hpp"
#include "words/connections.hpp"
#include "words/rates.hpp"

#include <hive/stall.hpp>

#include <doctest/doctest.h>

#include <algorithm>

using namespace hivectl;
using hive::Fate;
using hive::Reason;
using hive::StatusAnswer;
using namespace std::chrono_literals;

namespace {

constexpr std::int64_t registration = 77;

hive::EdgeStatus edge_to(const std::string& receiver, std::int64_t came, std::int64_t skipped)
{
    hive::EdgeStatus edge{.receiver = receiver,
                          .connected = true,
                          .registration = registration,
                          .options = {.window = 2, .group = {}, .lease = {}},
                          .encoding = "as it is"};
    edge.events.came(came);
    edge.events.went(Fate::acknowledged, came - skipped);
    edge.events.went(Fate::skipped, skipped);
    return edge;
}

StatusAnswer camera(std::int64_t epoch, std::int64_t uptime_us, std::int64_t produced, std::int64_t skipped)
{
    hive::OutputStatus image{.name = "image", .type = "image/jpeg", .produced = produced};
    image.edges.push_back(edge_to("face.image", produced, skipped));
    hive::Status status{.name = "camera", .kind = "camera", .epoch = epoch, .state = hive::State::busy};
    status.uptime_us = uptime_us;
    status.outputs.push_back(image);
    return {"camera", status};
}

hive::Status& status_of(StatusAnswer& answer) { return std::get<hive::Status>(answer.status); }
hive::EdgeStatus& edge_of(StatusAnswer& camera) { return status_of(camera).outputs.at(0).edges.at(0); }

StatusAnswer face(std::int64_t uptime_us, std::int64_t busy_us, std::int64_t processed)
{
    hive::Status status{.name = "face", .kind = "face", .epoch = 1, .state = hive::State::busy};
    status.uptime_us = uptime_us;
    status.busy_us = busy_us;
    status.inputs.push_back({.input = "image",
                             .from = "camera.image",
                             .connected = true,
                             .registration = registration,
                             .processed = processed,
                             .last_age_us = 40'000});
    return {"face", status};
}

StatusAnswer silent(const std::string& drone) { return {drone, hive::Error(hive::Errc::timeout, "silent")}; }

}  // namespace

TEST_CASE("connections: what both ends know is one row with the counts of both")
{
    auto receiver = face(0, 0, 4);
    status_of(receiver).inputs[0].dropped = 2;
    const auto rows = connection_rows({camera(1, 0, 10, 4), receiver});
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].text("from") == "camera.image");
    CHECK(rows[0].text("to") == "face.image");
    CHECK(rows[0].text("known_by") == "both");
    CHECK(rows[0].text("state") == "connected");
    CHECK(rows[0].text("kind") == "receiver");
    CHECK(rows[0]["window"] == 2);
    CHECK(rows[0]["encoding"] == "as it is");
    CHECK(rows[0]["came"] == 10);
    CHECK(rows[0]["acknowledged"] == 6);
    CHECK(rows[0]["processed"] == 4);
    CHECK(rows[0]["dropped_by_receiver"] == 2);
    CHECK(rows[0]["missing"] == 2);
    CHECK(rows[0]["age_us"] == 40'000);
}

TEST_CASE("connections: each end has its host, also one that does not answer, and what is no drone known here has none")
{
    auto sender = camera(1, 0, 10, 4), receiver = face(0, 0, 4), lost = silent("face");
    sender.place = {.drone = "camera", .host = "cam1", .address = "tcp://cam1:7700"};
    receiver.place = {.drone = "face", .host = hive::Place::here, .address = "unix:/tmp/face.sock"};
    lost.place = {.drone = "face", .host = "gpu1", .address = "tcp://gpu1:7700"};
    const auto here = connection_rows({sender, receiver}).at(0);
    CHECK(here["from_host"] == "cam1");
    CHECK(here["to_host"] == hive::Place::here);
    CHECK(connection_rows({sender, lost}).at(0)["to_host"] == "gpu1");
    CHECK(connection_rows({sender}).at(0)["to_host"].is_null());
    edge_of(sender).receiver = "app-1";
    CHECK(connection_rows({sender}).at(0)["to_host"].is_null());
}

TEST_CASE("connections: every fate of the ledger has a key, and lost is their sum")
{
    auto sender = camera(1, 0, 0, 0);
    edge_of(sender).events.came(9);
    for (std::size_t fate = 0; fate < hive::fates; ++fate)
        edge_of(sender).events.went(static_cast<Fate>(fate));
    const auto row = connection_rows({sender}).at(0);
    for (std::size_t fate = 0; fate < hive::fates; ++fate)
        CHECK(row[token(static_cast<Fate>(fate))] == 1);
    CHECK(row["lost"] == 4);
    CHECK(row["missing"] == 6);
    CHECK(row["in_flight"] == 0);
}

TEST_CASE("connections: the way of the bodies is told by what went through shared memory and what could not")
{
    const auto way = [](std::int64_t shared, std::int64_t fallback) {
        auto answer = camera(1, 0, 10, 4);
        edge_of(answer).shared = shared;
        edge_of(answer).fallback = fallback;
        return connection_rows({answer})[0].text("way");
    };
    CHECK(way(6, 0) == "memory");
    CHECK(way(4, 2) == "memory, 2 by socket");
    CHECK(way(0, 6) == "socket");
    CHECK(connection_rows({camera(1, 0, 4, 4)})[0]["way"].is_null());
}

TEST_CASE("connections: what only one end knows says which one")
{
    const auto sender_only = connection_rows({camera(1, 0, 10, 4), silent("face")});
    REQUIRE(sender_only.size() == 1);
    CHECK(sender_only[0].text("known_by") == "sender");
    CHECK(sender_only[0]["processed"].is_null());
    const auto receiver_only = connection_rows({face(0, 0, 0), silent("camera")});
    REQUIRE(receiver_only.size() == 1);
    CHECK(receiver_only[0].text("known_by") == "receiver");
    CHECK(receiver_only[0]["acknowledged"].is_null());
}

TEST_CASE("connections: another registration of the same name is another edge, unless the receiver only comes back")
{
    auto sender = camera(1, 0, 10, 4);
    edge_of(sender).registration = registration - 1;
    edge_of(sender).connected = false;
    auto receiver = face(0, 0, 0);
    CHECK(connection_rows({sender, receiver}).size() == 2);
    status_of(receiver).inputs[0].connected = false;
    const auto rows = connection_rows({sender, receiver});
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].text("state") == "gone");
}

TEST_CASE("connections: a receiver whose place is kept is shown as such, with the reason")
{
    auto sender = camera(1, 0, 10, 4);
    edge_of(sender).connected = false;
    edge_of(sender).why = Reason::place_kept;
    const auto row = connection_rows({sender}).at(0);
    CHECK(row.text("state") == "place_kept");
    CHECK(row.text("why") == "place_kept");
}

TEST_CASE("connections: the reason is the sender's, or else the receiver's")
{
    auto sender = camera(1, 0, 10, 4);
    auto receiver = face(0, 0, 0);
    CHECK(connection_rows({sender, receiver})[0]["why"].is_null());
    status_of(receiver).inputs[0].why = Reason::halted;
    CHECK(connection_rows({sender, receiver})[0].text("why") == "halted");
    edge_of(sender).why = Reason::not_asked;
    CHECK(connection_rows({sender, receiver})[0].text("why") == "not_asked");
}

TEST_CASE("connections: a group stands before its members, and what a member discards is not missing")
{
    auto sender = camera(1, 0, 10, 4);
    auto& edges = status_of(sender).outputs[0].edges;
    edges[0].options.group = "faces";
    edges.push_back(edge_to("zoo.image", 3, 0));
    hive::EdgeStatus group{.receiver = "group faces", .group = true};
    group.options.group = "faces";
    edges.push_back(group);
    auto receiver = face(0, 0, 0);
    status_of(receiver).inputs[0].discarded = 5;
    const auto rows = connection_rows({sender, receiver});
    REQUIRE(rows.size() == 3);
    CHECK(rows[0].text("to") == "zoo.image");
    CHECK(rows[1].text("kind") == "group");
    CHECK(rows[1]["state"].is_null());
    CHECK(rows[2].text("kind") == "member");
    CHECK(rows[2].text("to") == "face.image");
    CHECK(rows[2]["discarded"] == 5);
    CHECK(rows[2]["missing"] == 0);
}

TEST_CASE(
    "connections: a window that a round trip makes too small is advised against, and only where events are skipped")
{
    const auto advised = [](std::int64_t round_trip_us, int window, std::int64_t skipped) {
        auto from = camera(1, 1'000'000, 100, skipped), to = face(0, 0, 0);
        status_of(from).outputs[0].edges[0].options.window = window;
        status_of(to).inputs[0].round_trip_us = round_trip_us;
        return connection_rows({from, to}).at(0)["window_advised"];
    };
    CHECK(advised(100'000, 1, 50) == 7);
    CHECK(advised(100'000, 7, 50).is_null());
    CHECK(advised(100'000, 1, 0).is_null());
    CHECK(advised(900, 1, 50).is_null());
    CHECK(advised(0, 1, 50).is_null());
    CHECK(advised(60'000'000, 1, 50) == 64);
}

TEST_CASE("rates: clocks that are more than 100 ms apart are shown")
{
    const auto skew = [](std::int64_t offset_us) {
        auto to = face(0, 0, 0);
        status_of(to).inputs[0].round_trip_us = 1000;
        status_of(to).inputs[0].clock_offset_us = offset_us;
        const std::vector looks{camera(1, 1'000'000, 100, 0), to};
        return rates_between(looks, looks, 1s).edges.at(0)["skew_us"];
    };
    CHECK(skew(50'000).is_null());
    CHECK(skew(-250'000) == -250'000);
}

TEST_CASE("rates: differences over the time between, and the busiest receiver is marked slowest")
{
    const auto rates = rates_between({camera(1, 1'000'000, 10, 4), face(1'000'000, 500'000, 5)},
                                     {camera(1, 3'000'000, 50, 24), face(3'000'000, 2'000'000, 25)}, 2s);
    REQUIRE(rates.drones.size() == 2);
    CHECK(rates.drones[0].number("out_per_s") == doctest::Approx(20));
    CHECK(rates.drones[1].number("in_per_s") == doctest::Approx(10));
    CHECK(rates.drones[1].number("busy_percent") == doctest::Approx(75));
    CHECK(rates.drones[0]["slowest"].is_null());
    CHECK(rates.drones[1]["slowest"] == true);
    REQUIRE(rates.edges.size() == 1);
    CHECK(rates.edges[0].number("acknowledged_per_s") == doctest::Approx(10));
    CHECK(rates.edges[0].number("skipped_per_s") == doctest::Approx(10));
    CHECK(rates.edges[0]["losing"].is_null());
}

TEST_CASE("rates: an edge whose receiver drops is marked, even when the sender has lost nothing")
{
    auto later = face(3'000'000, 0, 0);
    status_of(later).inputs[0].dropped = 8;
    const auto rates = rates_between({camera(1, 0, 10, 0), face(0, 0, 0)}, {camera(1, 2'000'000, 20, 0), later}, 2s);
    CHECK(rates.edges.at(0).number("dropped_by_receiver_per_s") == doctest::Approx(4));
    CHECK(rates.edges.at(0).number("dropped_per_s") == 0);
    CHECK(rates.edges.at(0)["losing"] == true);
}

TEST_CASE("rates: a drone restarted in between has none yet")
{
    const auto rates = rates_between({camera(1, 9'000'000, 1000, 0)}, {camera(2, 100'000, 3, 0)}, 2s);
    REQUIRE(rates.drones.size() == 1);
    CHECK(rates.drones[0]["out_per_s"].is_null());
    CHECK(rates.edges.at(0)["acknowledged_per_s"].is_null());
}

TEST_CASE("rates: two receivers of one name are each compared with themselves")
{
    const auto twice = [](std::int64_t first, std::int64_t second) {
        auto answer = camera(1, 0, 0, 0);
        status_of(answer).outputs[0].edges = {edge_to("app-1", first, 0), edge_to("app-1", second, 0)};
        return answer;
    };
    const auto rates = rates_between({twice(10, 100)}, {twice(12, 108)}, 2s);
    REQUIRE(rates.edges.size() == 2);
    CHECK(rates.edges[0].number("acknowledged_per_s") == doctest::Approx(1));
    CHECK(rates.edges[1].number("acknowledged_per_s") == doctest::Approx(4));
}

TEST_CASE("stall: an output that has been quiet for a second names its reason and the receivers it is about")
{
    auto status = std::get<hive::Status>(camera(1'000'000, 5'000'000, 10, 4).status);
    auto& output = status.outputs[0];
    output.last_emitted_us = 2'000'000;
    CHECK(stall_text(status).empty());
    output.why = output.edges[0].why = Reason::place_kept;
    CHECK(stall_text(status) == "image: it waits for a receiver that was cut off, or has not come yet (face.image)");
    output.last_emitted_us = 5'500'000;  // half a second ago
    CHECK(stall_text(status).empty());
}

TEST_CASE("stall: of many receivers the first three are named")
{
    auto status = std::get<hive::Status>(camera(1, 5'000'000, 0, 0).status);
    status.outputs[0].why = Reason::not_asked;
    status.outputs[0].edges.clear();
    for (int i = 1; i <= 5; ++i) {
        status.outputs[0].edges.push_back(edge_to("s" + std::to_string(i), 0, 0));
        status.outputs[0].edges.back().why = Reason::not_asked;
    }
    CHECK(stall_text(status) == "image: waits for s1, s2, s3 and 2 more to ask");
}

TEST_CASE("stall: a detector may have an output that nobody receives, a camera may not")
{
    auto detector = std::get<hive::Status>(face(5'000'000, 0, 0).status);
    detector.outputs.push_back({.name = "faces", .type = "application/json", .why = Reason::no_receiver});
    CHECK(stall_text(detector).empty());
    auto source = std::get<hive::Status>(camera(1, 5'000'000, 0, 0).status);
    source.outputs[0].why = Reason::no_receiver;
    source.outputs.push_back({.name = "exceptions", .type = "application/json", .why = Reason::no_receiver});
    CHECK(stall_text(source) == "image: no receivers");
}

TEST_CASE("stall: an input says which sender it misses")
{
    auto status = std::get<hive::Status>(face(5'000'000, 0, 0).status);
    status.inputs[0].why = Reason::dialing;
    CHECK(stall_text(status) == "image from camera.image: the sender is not connected");
}

TEST_CASE("rates: events of an output without receivers are not counted")
{
    auto earlier = camera(1, 0, 10, 0), later = camera(1, 2'000'000, 50, 0);
    status_of(earlier).outputs.push_back({.name = "other", .type = "image/png", .produced = 10, .unreceived = 10});
    status_of(later).outputs.push_back({.name = "other", .type = "image/png", .produced = 50, .unreceived = 50});
    CHECK(rates_between({earlier}, {later}, 2s).drones[0].number("out_per_s") == doctest::Approx(20));
}

TEST_CASE("activity: an idle source that emits is sending, and says how far it is in its file")
{
    hive::Status status{.name = "camera", .kind = "camera", .epoch = 1'000'000, .state = hive::State::idle};
    status.uptime_us = 9'000'000;
    status.source_events = 300;
    status.outputs.push_back({.name = "image", .type = "image/png", .produced = 123, .last_emitted_us = 9'900'000});
    CHECK(hivectl::activity_text(status) == "sending");
    CHECK(hivectl::source_text(status) == "123 of 300");
    hivectl::Row row{{"state", "idle"}};
    hivectl::show_activity(row, status);
    CHECK(row.json() == R"({"state":"sending","done":"123 of 300"})");
    status.uptime_us = 11'000'000;
    status.source_events = 0;
    CHECK(hivectl::activity_text(status) == "idle");
    CHECK(hivectl::source_text(status).empty());
}
