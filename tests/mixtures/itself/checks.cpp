// Statuses that add up, and such that do not.
#include "../watch.hpp"

#include <doctest/doctest.h>

using namespace hive;
using namespace hive::mixtures;

namespace {

/// source.tick -> a1.image, seven sent and dealt with.
Statuses good()
{
    EdgeStatus edge;
    edge.receiver = "a1.image";
    edge.connected = true;
    edge.registration = 5;
    edge.events.came(9);
    edge.events.went(Fate::acknowledged, 7);
    edge.events.went(Fate::skipped, 2);
    OutputStatus output;
    output.name = "tick";
    output.produced = 9;
    output.edges = {edge};
    InputStatus input;
    input.input = "image";
    input.from = "source.tick";
    input.connected = true;
    input.registration = 5;
    input.received = input.processed = 7;
    Statuses statuses{{"source", {}}, {"a1", {}}};
    statuses["source"].outputs = {output};
    statuses["a1"].inputs = {input};
    return statuses;
}

const std::map<std::string, int> together{{source, 0}, {"a1", 0}};

EdgeStatus& edge_of(Statuses& statuses) { return statuses.at("source").outputs[0].edges[0]; }
InputStatus& input_of(Statuses& statuses) { return statuses.at("a1").inputs[0]; }

}  // namespace

TEST_CASE("mixtures: accounts that add up are no problem")
{
    const auto statuses = good();
    CHECK(unbalanced(statuses).empty());
    CHECK(disagreeing(statuses, together).empty());
    CHECK(without_reason(statuses).empty());
    CHECK(idle(statuses));
    CHECK(connected(statuses, {source, "a1", {}}));
}

TEST_CASE("mixtures: an account that does not add up is a problem")
{
    auto statuses = good();
    edge_of(statuses).events.went(Fate::acknowledged);
    CHECK(unbalanced(statuses).size() == 1);
    statuses = good();
    ++input_of(statuses).received;
    CHECK(unbalanced(statuses).size() == 1);
    statuses = good();
    edge_of(statuses).events.came(1);
    CHECK(unbalanced(statuses).size() == 1);  // more than were produced
}

TEST_CASE("mixtures: a status that contradicts itself is a problem")
{
    auto statuses = good();
    CHECK(contradictory(statuses).empty());
    edge_of(statuses).last_lost_us = 1;
    CHECK(contradictory(statuses).size() == 1);
    statuses = good();
    ++input_of(statuses).abandoned;
    CHECK(contradictory(statuses).size() == 1);
    statuses = good();
    statuses.at("a1").state = State::halted;
    CHECK(contradictory(statuses).size() == 1);
    statuses.at("a1").halted = HaltStatus{.by = "", .time_us = 1};
    CHECK(contradictory(statuses).empty());
    statuses.at("a1").state = State::idle;
    CHECK(contradictory(statuses).size() == 1);
    statuses = good();
    input_of(statuses).registration = 0;
    CHECK(contradictory(statuses).size() == 1);
}

TEST_CASE("mixtures: a receiver with more than was sent, or less than it acknowledged, is a problem")
{
    auto statuses = good();
    ++input_of(statuses).received;
    CHECK(disagreeing(statuses, together).size() == 1);
    CHECK(disagreeing(statuses, {{source, 1}, {"a1", 0}}).empty());  // it received from an earlier life as well
    statuses = good();
    --input_of(statuses).received;
    CHECK(disagreeing(statuses, together).size() == 1);
    CHECK(disagreeing(statuses, {{source, 0}, {"a1", 1}}).empty());
}

TEST_CASE("mixtures: what is under way and does not move needs a reason")
{
    auto statuses = good();
    edge_of(statuses).events.came(1);
    CHECK(without_reason(statuses).size() == 1);
    CHECK_FALSE(idle(statuses));
    CHECK_FALSE(says_why(statuses.at("source")));
    edge_of(statuses).why = Reason::not_asked;
    CHECK(without_reason(statuses).empty());
    CHECK(says_why(statuses.at("source")));
}

TEST_CASE("mixtures: the receiver may be the one that says why, or it waits for its own receivers")
{
    auto statuses = good();
    edge_of(statuses).events.came(1);
    input_of(statuses).why = Reason::not_asked;
    CHECK(without_reason(statuses).empty());
    input_of(statuses).from = "somebody.else";
    CHECK(without_reason(statuses).size() == 1);
    EdgeStatus own;
    own.receiver = "b1.image";
    OutputStatus output;
    output.name = "result";
    output.edges = {own};
    statuses.at("a1").outputs = {output};
    CHECK(without_reason(statuses).size() == 1);
    statuses.at("a1").outputs[0].edges[0].events.came(1);
    CHECK(without_reason(statuses).empty());  // b1 does not answer, so nothing can be asked of it
}

TEST_CASE("mixtures: exceptions are heard by who is connected to them")
{
    auto statuses = good();
    CHECK_FALSE(heard(statuses, "nobody"));
    CHECK_FALSE(heard(statuses, "source"));  // its tick is received, which is something else
    OutputStatus exceptions;
    exceptions.name = "exceptions";
    exceptions.edges = {edge_of(statuses)};
    statuses.at("source").outputs.push_back(exceptions);
    auto& edge = statuses.at("source").outputs.back().edges[0];
    CHECK_FALSE(heard(statuses, "source"));  // a1 is somebody else
    edge.receiver = hearer;
    CHECK(heard(statuses, "source"));
    edge.connected = false;
    CHECK_FALSE(heard(statuses, "source"));
}

TEST_CASE("mixtures: a counter that goes back is a problem, unless its registration or its drone is another one")
{
    Watch watch;
    auto statuses = good();
    const auto fewer = [] {
        auto few = good();
        edge_of(few).events = {};
        input_of(few).received = input_of(few).processed = 3;
        return few;
    };
    CHECK(watch.look(statuses).empty());
    CHECK(watch.look(statuses).empty());
    CHECK(watch.look(fewer()).size() == 2);
    CHECK(watch.look(statuses).empty());
    auto registered_again = fewer();
    edge_of(registered_again).registration = input_of(registered_again).registration = 6;
    CHECK(watch.look(registered_again).empty());
    CHECK(watch.look(statuses).empty());
    auto started_again = fewer();
    for (auto& [name, status] : started_again)
        ++status.epoch;
    CHECK(watch.look(started_again).empty());
}
