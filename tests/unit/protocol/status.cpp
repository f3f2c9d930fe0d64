// The account of an edge, and the status of a drone through text.
#include <hive/error.hpp>
#include <hive/status.hpp>

#include <doctest/doctest.h>

#include <algorithm>

using namespace hive;

namespace {

Status through_text(const Status& status) { return status_from_json(parse_json(to_text(to_json(status)))); }

Status small()
{
    Status status;
    status.name = status.kind = "face";
    return status;
}

InputStatus full_input()
{
    return {.input = "image",
            .from = "camera.image",
            .address = "tcp://cam1:7700",
            .connected = true,
            .registration = 12,
            .options = {.window = 3, .group = "workers"},
            .received = 36,
            .processed = 1,
            .abandoned = 2,
            .duplicates = 3,
            .discarded = 4,
            .dropped = 5,
            .unmatched = 6,
            .queued = 7,
            .in_hand = 8,
            .last_age_us = 9,
            .error = "connection lost",
            .why = Reason::dialing};
}

EdgeStatus full_edge()
{
    EdgeStatus edge{.receiver = "group workers",
                    .group = true,
                    .connected = true,
                    .registration = 4,
                    .options = {.window = 2, .group = "workers"},
                    .encoding = "jpeg:80",
                    .events = {},
                    .waiting = 2,
                    .shared = 5,
                    .fallback = 6,
                    .why = Reason::group_awaited};
    edge.events.came(100);
    for (std::size_t fate = 0; fate < fates; ++fate)
        edge.events.went(static_cast<Fate>(fate), static_cast<std::int64_t>(fate) + 1);
    return edge;
}

}  // namespace

TEST_CASE("ledger: what came is what went and what is in flight")
{
    Ledger ledger;
    ledger.came();
    ledger.came(9);
    CHECK(ledger.in_flight() == 10);
    ledger.went(Fate::acknowledged, 4);
    ledger.went(Fate::lost_killed);
    ledger.went(Fate::lost_left, 2);
    CHECK(ledger.total() == 10);
    CHECK(ledger.of(Fate::acknowledged) == 4);
    CHECK(ledger.of(Fate::skipped) == 0);
    CHECK(ledger.lost() == 3);
    CHECK(ledger.in_flight() == 3);
}

TEST_CASE("status: an edge comes back with each fate and what is in flight")
{
    Status status = small();
    status.outputs.push_back({.name = "image",
                              .type = "image/jpeg",
                              .produced = 7,
                              .unreceived = 1,
                              .last_emitted_us = 5,
                              .edges = {full_edge()},
                              .why = Reason::held});
    status.rows_left_out = 3;
    const auto read = through_text(status);
    CHECK(read.rows_left_out == 3);
    const auto output = read.outputs.at(0);
    CHECK(output.name == "image");
    CHECK(output.type == "image/jpeg");
    CHECK(output.produced == 7);
    CHECK(output.unreceived == 1);
    CHECK(output.last_emitted_us == 5);
    CHECK(output.why == Reason::held);
    const auto edge = output.edges.at(0), sent = full_edge();
    CHECK(edge.receiver == sent.receiver);
    CHECK(edge.group);
    CHECK(edge.connected);
    CHECK(edge.registration == 4);
    CHECK(edge.options == sent.options);
    CHECK(edge.encoding == "jpeg:80");
    CHECK(edge.events == sent.events);
    CHECK(edge.events.in_flight() == 100 - 45);
    CHECK(edge.waiting == 2);
    CHECK(edge.shared == 5);
    CHECK(edge.fallback == 6);
    CHECK(edge.why == Reason::group_awaited);
}

TEST_CASE("status: an input comes back with each count")
{
    Status status = small();
    status.inputs.push_back(full_input());
    const auto input = through_text(status).inputs.at(0);
    CHECK(input.from == "camera.image");
    CHECK(input.address == "tcp://cam1:7700");
    CHECK(input.connected);
    CHECK(input.registration == 12);
    CHECK(input.options.group == "workers");
    CHECK(input.received
          == input.processed + input.abandoned + input.duplicates + input.discarded + input.dropped + input.unmatched
                 + input.queued + input.in_hand);
    CHECK(input.received == 36);
    CHECK(input.in_hand == 8);
    CHECK(input.last_age_us == 9);
    CHECK(input.error == "connection lost");
    CHECK(input.why == Reason::dialing);
}

TEST_CASE("status: the drone's own fields, its matching and its last exception come back")
{
    Status status = small();
    status.pid = 42;
    status.epoch = 43;
    status.state = State::halted;
    status.policy = ExceptionPolicy::halt;
    status.condition = "no light";
    status.uptime_us = 1;
    status.busy_us = 2;
    status.busy_for_us = 3;
    status.callback = "image";
    status.encoding_us = 4;
    status.cpu_us = 5;
    status.memory = 6;
    status.machine = {.processors = 7, .cpu_us = 8, .memory = 9, .memory_available = 10, .memory_limited = true};
    status.why = Reason::halted;
    status.source_events = 300;
    status.version = "0.1.0";
    status.matching.push_back({.inputs = {"image", "marks"},
                               .sets = 1,
                               .waiting = 2,
                               .unmatched = 3,
                               .duplicates = 4,
                               .missing = {{"marks", 3}}});
    status.halted = HaltStatus{.by = "hivectl-7 (pid 7)", .time_us = 5};
    status.last_exception = ExceptionStatus{.code = "failed",
                                            .text = "no face",
                                            .policy = "halt",
                                            .input = "image",
                                            .time_us = 5,
                                            .source = "camera",
                                            .sequence = 6};
    CHECK(to_json(through_text(status)) == to_json(status));
    const auto back = through_text(status);
    CHECK(back.pid == 42);
    CHECK(back.state == State::halted);
    CHECK(back.policy == ExceptionPolicy::halt);
    CHECK(back.condition == "no light");
    CHECK(back.callback == "image");
    CHECK(back.why == Reason::halted);
    CHECK(back.source_events == 300);
    CHECK(back.version == "0.1.0");
    CHECK(back.memory == 6);
    CHECK(back.machine.processors == 7);
    CHECK(back.machine.memory_available == 10);
    CHECK(back.machine.memory_limited);
    CHECK(back.matching.at(0).missing.at("marks") == 3);
    REQUIRE(back.halted);
    CHECK(back.halted->by == "hivectl-7 (pid 7)");
    CHECK(back.halted->time_us == 5);
    REQUIRE(back.last_exception);
    CHECK(back.last_exception->text == "no face");
    CHECK(back.last_exception->sequence == 6);
}

TEST_CASE("status: the totals are of all inputs, those that were left too")
{
    Status status = small();
    status.inputs.push_back(full_input());
    status.left.push_back(full_input());
    const auto json = to_json(status);
    CHECK(json.at("events").at("received") == 72);
    CHECK(json.at("events").at("duplicates") == 6);
    CHECK(through_text(status).left.at(0).received == 36);
}

TEST_CASE("status: each reason and each fate has a word of its own")
{
    std::vector<std::string_view> words;
    for (int reason = 1; reason <= static_cast<int>(Reason::watched); ++reason) {
        Status status = small();
        status.why = static_cast<Reason>(reason);
        CHECK(through_text(status).why == status.why);
        words.push_back(token(status.why));
    }
    for (std::size_t fate = 0; fate < fates; ++fate)
        words.push_back(token(static_cast<Fate>(fate)));
    std::ranges::sort(words);
    CHECK(std::ranges::adjacent_find(words) == words.end());
    CHECK_FALSE(words.front().empty());
    CHECK(token(Reason::none).empty());
}

TEST_CASE("status: a reason of a newer drone is no reason to refuse the rest, a wrong number is")
{
    auto json = to_json(small());
    json["why"] = "moon_phase";
    CHECK(status_from_json(json).why == Reason::none);
    json["pid"] = "many";
    CHECK_THROWS_AS(status_from_json(json), Error);
    CHECK_THROWS_AS(status_from_json(Json::object()), Error);
}
