// Tests of joining both ends' tables and of rates between two looks.
#include "connections.hpp"
#include "rates.hpp"

#include <doctest/doctest.h>

using namespace hivectl;
using hive::Answer;
using hive::Json;
using namespace std::chrono_literals;

namespace {

Answer camera(std::int64_t epoch, std::int64_t uptime_us, std::int64_t produced, std::int64_t skipped)
{
    const Json receiver{{"receiver", "face.image"}, {"transfer", "sync"},   {"window", 2},
                        {"encoding", "as it is"},   {"produced", produced}, {"delivered", produced - skipped},
                        {"skipped", skipped}};
    return {
        "camera",
        Json{{"epoch", epoch},
             {"state", "busy"},
             {"uptime_us", uptime_us},
             {"outputs",
              Json::array({Json{{"name", "image"}, {"produced", produced}, {"receivers", Json::array({receiver})}}})}},
        {}};
}

Answer face(std::int64_t uptime_us, std::int64_t busy_us, std::int64_t processed)
{
    return {
        "face",
        Json{{"epoch", 1},
             {"state", "busy"},
             {"uptime_us", uptime_us},
             {"busy_us", busy_us},
             {"events", Json{{"processed", processed}}},
             {"inputs",
              Json::array({Json{
                  {"input", "image"}, {"from", "camera.image"}, {"state", "connected"}, {"last_age_us", 40'000}}})}},
        {}};
}

}  // namespace

TEST_CASE("connections: what both ends know is one row with the sender's counters and the receiver's state")
{
    const auto rows = connection_rows({camera(1, 0, 10, 4), face(0, 0, 0)});
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].text("from") == "camera.image");
    CHECK(rows[0].text("to") == "face.image");
    CHECK(rows[0].text("known_by") == "both");
    CHECK(rows[0].text("state") == "connected");
    CHECK(rows[0]["window"] == 2);
    CHECK(rows[0]["encoding"] == "as it is");
    CHECK(rows[0]["delivered"] == 6);
    CHECK(rows[0]["age_us"] == 40'000);
}

TEST_CASE("connections: the way of the bodies is told by what went through shared memory and what could not")
{
    const auto way = [](std::int64_t shared, std::int64_t fallback) {
        auto answer = camera(1, 0, 10, 4);
        auto& receiver = answer.result["outputs"][0]["receivers"][0];
        receiver["shared"] = shared;
        receiver["fallback"] = fallback;
        return connection_rows({answer})[0].text("way");
    };
    CHECK(way(6, 0) == "memory");
    CHECK(way(4, 2) == "memory, 2 by socket");
    CHECK(way(0, 6) == "socket");
    CHECK(connection_rows({camera(1, 0, 4, 4)})[0]["way"].is_null());
}

TEST_CASE("connections: what only one end knows says which one")
{
    const auto sender_only = connection_rows({camera(1, 0, 10, 4)});
    REQUIRE(sender_only.size() == 1);
    CHECK(sender_only[0].text("known_by") == "sender");
    const auto receiver_only =
        connection_rows({face(0, 0, 0), {"camera", {}, hive::Error(hive::Errc::timeout, "silent")}});
    REQUIRE(receiver_only.size() == 1);
    CHECK(receiver_only[0].text("known_by") == "receiver");
    CHECK(receiver_only[0]["delivered"].is_null());
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
    CHECK(rates.edges[0].number("delivered_per_s") == doctest::Approx(10));
    CHECK(rates.edges[0].number("skipped_per_s") == doctest::Approx(10));
}

TEST_CASE("rates: a drone restarted in between has none yet")
{
    const auto rates = rates_between({camera(1, 9'000'000, 1000, 0)}, {camera(2, 100'000, 3, 0)}, 2s);
    REQUIRE(rates.drones.size() == 1);
    CHECK(rates.drones[0]["out_per_s"].is_null());
    CHECK(rates.edges.at(0)["delivered_per_s"].is_null());
}
