// Rows of audit that are right, and such that are not.
#include "../audited.hpp"

#include <hive/status.hpp>

#include <doctest/doctest.h>

using namespace hive;
using namespace hive::soak;

namespace {

/// source.tick -> a1.image: nine came; seven were acknowledged, two went to another member.
Json good_row()
{
    Json row{{"from", "source.tick"},
             {"to", "a1.image"},
             {"state", "both ends"},
             {"came", 9},
             {"in_flight", 0},
             {"losses", Json::array()},
             {"lost", 0},
             {"differences", Json::array()},
             {"verdict", "ok"}};
    for (std::size_t fate = 0; fate < fates; ++fate)
        row[token(static_cast<Fate>(fate))] = 0;
    row["acknowledged"] = 7;
    row["passed_on"] = 2;
    return row;
}

Json lossy_row(const char* fate, const char* at)
{
    auto row = good_row();
    row["losses"].push_back({{"fate", fate}, {"at", at}, {"events", 1}, {"promised", true}});
    row["lost"] = 1;
    row["verdict"] = "lost";
    return row;
}

const Known at_rest{.at_rest = true, .failures = {}, .given_up = {}, .connections = {{"source", "a1"}}, .breaks = 0};

std::size_t problems(const Json& row, const Known& known = at_rest)
{
    return misjudged(Json::array({row}), known).size();
}

}  // namespace

TEST_CASE("soak: a row of audit that adds up is no problem")
{
    CHECK(problems(good_row()) == 0);
    auto gone = good_row();
    gone["state"] = "sender gone";
    for (const auto* key : {"came", "in_flight", "acknowledged", "passed_on"})
        gone[key] = nullptr;
    CHECK(misjudged(Json::array({good_row(), gone}), at_rest).empty());
}

TEST_CASE("soak: a row of audit that does not add up is a problem")
{
    auto row = good_row();
    row["acknowledged"] = 6;
    CHECK(problems(row) == 1);
    row["in_flight"] = 1;
    CHECK(problems(row) == 1);  // at rest nothing is in flight
    auto running = at_rest;
    running.at_rest = false;
    CHECK(problems(row, running) == 0);
    row = good_row();
    row["differences"].push_back("the sender counts more");
    row["verdict"] = "differs";
    CHECK(problems(row) == 1);
    row = good_row();
    row["verdict"] = "lost";
    CHECK(problems(row) == 1);
}

TEST_CASE("soak: an accusation is a problem when nothing is missing")
{
    for (const auto* fate : {"dropped", "lost_connection", "lost_killed", "lost_cut_off"})
        CHECK(problems(lossy_row(fate, "source")) == 1);
    CHECK(problems(lossy_row("abandoned", "source")) == 1);
    CHECK(problems(lossy_row("abandoned", "a1")) == 1);
}

TEST_CASE("soak: a drone that only watches may lose a notification each time that a connection breaks")
{
    auto row = lossy_row("lost_killed", "source");
    row["to"] = "watcher.image";
    auto known = at_rest;
    known.connections = {{"source", "watcher"}};
    CHECK(problems(row, known) == 1);
    known.breaks = 1;
    CHECK(problems(row, known) == 0);
}

TEST_CASE("soak: as many events are abandoned as exceptions came")
{
    auto known = at_rest;
    known.failures = {{"a1", 1}};
    CHECK(problems(lossy_row("abandoned", "a1"), known) == 0);
    CHECK(problems(good_row(), known) == 1);  // audit misses the loss
    known.failures = {{"a1", 2}};
    CHECK(problems(lossy_row("abandoned", "a1"), known) == 1);
    known = at_rest;
    known.given_up = {{"source", 1}};
    CHECK(problems(lossy_row("abandoned", "source"), known) == 0);
}

TEST_CASE("soak: a connection without a row is a problem")
{
    CHECK(misjudged(Json::array(), at_rest).size() == 1);
    auto row = good_row();
    row["state"] = "sender only";
    CHECK(problems(row) == 1);
}
