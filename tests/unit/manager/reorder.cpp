// Results of shared work back in the order of the turns.
#include "reorder.hpp"

#include <doctest/doctest.h>

namespace hive {
namespace {

using namespace std::chrono_literals;
using Turns = std::vector<std::int64_t>;

const Reorder::TimePoint start{};

struct Made {
    std::int64_t closed = 0;  ///< what the share says
    bool lossless = true;
    std::int64_t epoch = 1;
    std::string of = "camera.image#workers";
    int part = 0;
};

Identity identity(std::int64_t turn, const Made& made = {})
{
    // A live source skips two of three; the turns are without gaps.
    return {.source = "camera",
            .epoch = made.epoch,
            .sequence = 3 * turn,
            .lossless = made.lossless,
            .part = made.part,
            .shares = {{.of = made.of, .epoch = made.epoch, .turn = turn, .closed = made.closed}}};
}

/// Whether all were taken.
bool push(Reorder& reorder, std::initializer_list<std::int64_t> turns, const Made& made = {},
          Reorder::TimePoint now = start)
{
    bool all = true;
    for (const auto turn : turns) {
        Event event;
        event.identity = identity(turn, made);
        all = reorder.push(std::move(event), now) && all;
    }
    return all;
}

Turns drain(Reorder& reorder)
{
    Turns result;
    while (auto event = reorder.pop())
        result.push_back(event->identity.shared_work() ? event->identity.shared_work()->turn
                                                       : event->identity.sequence);
    return result;
}

/// A result of work that a stage, in one of its runs, gave to a group.
Event redone(std::int64_t sequence, std::int64_t turn, std::int64_t run)
{
    Event event;
    event.identity = {.source = "camera",
                      .epoch = 1,
                      .sequence = sequence,
                      .lossless = true,
                      .shares = {{.of = "edges.image#workers", .epoch = run, .turn = turn}}};
    return event;
}

Turns sequences(Reorder& reorder)
{
    Turns all;
    while (const auto event = reorder.pop())
        all.push_back(event->identity.sequence);
    return all;
}

Share standing(std::int64_t turn, std::int64_t closed)
{
    return {.of = "camera.image#workers", .epoch = 1, .turn = turn, .closed = closed};
}

}  // namespace

TEST_CASE("reorder: results come out in the order of the turns, whatever the source skips between them")
{
    for (const bool lossless : {true, false}) {
        Reorder reorder(30s);
        push(reorder, {2, 1, 4, 3}, {.lossless = lossless});
        CHECK(drain(reorder) == Turns{1, 2, 3, 4});
    }
}

TEST_CASE("reorder: the first turn may be the slowest")
{
    Reorder reorder(30s);
    reorder.expect(standing(0, 0), {});
    push(reorder, {3, 2, 4});
    reorder.expire(start + 29s);
    CHECK(drain(reorder).empty());
    push(reorder, {1}, {}, start + 29s);
    CHECK(drain(reorder) == Turns{1, 2, 3, 4});
    CHECK(reorder.missing() == 0);
}

TEST_CASE("reorder: a missing result holds up those after it until the timeout is over, and is named")
{
    Reorder reorder(30s);
    push(reorder, {1, 3, 4});
    CHECK(drain(reorder) == Turns{1});
    CHECK(reorder.deadline() == start + 30s);
    reorder.expire(start + 30s - 1ns);
    CHECK(drain(reorder).empty());
    reorder.expire(start + 30s);
    CHECK(drain(reorder) == Turns{3, 4});
    CHECK(reorder.missing() == 1);
    CHECK(reorder.missing_turns().at("camera.image#workers") == Turns{2});
    CHECK_FALSE(reorder.deadline());
}

TEST_CASE("reorder: a lossless turn that is closed has no result if it is not here, and nobody waits for it")
{
    Reorder reorder(30s);
    push(reorder, {1});
    push(reorder, {20}, {.closed = 19});
    reorder.expire(start);
    CHECK(drain(reorder) == Turns{1, 20});
    CHECK(reorder.missing() == 0);
}

TEST_CASE("reorder: a lossless result of a closed turn that comes late is missing: its worker left and still held it")
{
    Reorder reorder(30s);
    push(reorder, {1});
    push(reorder, {20}, {.closed = 19});
    reorder.expire(start);
    CHECK(drain(reorder) == Turns{1, 20});
    for (int i = 0; i < 2; ++i) {
        CHECK_FALSE(push(reorder, {7}, {.closed = 1}));
        CHECK(drain(reorder).empty());
        CHECK(reorder.missing() == 1);
    }
}

TEST_CASE("reorder: a live turn that is closed and of which no result comes is given up quickly")
{
    Reorder reorder(30s);
    push(reorder, {1}, {.lossless = false});
    push(reorder, {3}, {.closed = 2, .lossless = false});
    reorder.expire(start + Reorder::closed_timeout - 1ns);
    CHECK(drain(reorder) == Turns{1});
    reorder.expire(start + Reorder::closed_timeout);
    CHECK(drain(reorder) == Turns{3});
    CHECK(reorder.missing_turns().at("camera.image#workers") == Turns{2});
}

TEST_CASE("reorder: closed turns that have no result hold up the next one together, not each for itself")
{
    Reorder reorder(30s);
    push(reorder, {1}, {.lossless = false});
    push(reorder, {20}, {.closed = 19, .lossless = false});
    reorder.expire(start + Reorder::closed_timeout);
    CHECK(drain(reorder) == Turns{1, 20});
    CHECK(reorder.missing() == 18);
}

TEST_CASE("reorder: results of an earlier run stand where their captures are among those of the next one")
{
    Reorder reorder(30s);
    for (const std::int64_t of : {1, 3, 5})
        reorder.push(redone(of, of, 7), start);
    CHECK(sequences(reorder) == Turns{1});
    // What it had not finished is done again, but for what was answered; 4 is still under way from the earlier run.
    reorder.push(redone(2, 1, 8), start);
    CHECK(sequences(reorder) == Turns{2});
    reorder.skip(redone(3, 2, 8).identity, start);
    reorder.push(redone(4, 4, 7), start);
    reorder.skip(redone(4, 3, 8).identity, start);
    CHECK(sequences(reorder).empty());
    SUBCASE("up to a later one")
    {
        reorder.push(redone(6, 5, 8), start);
        reorder.skip(redone(5, 4, 8).identity, start);
        CHECK(sequences(reorder) == Turns{3, 4, 5, 6});
        reorder.push(redone(5, 5, 7), start);
        CHECK(sequences(reorder) == Turns{5});
    }
    SUBCASE("up to the end")
    {
        CHECK(reorder.deadline() == start + 30s);
        reorder.finish(start);
        reorder.expire(start + Reorder::closed_timeout);
        CHECK(sequences(reorder) == Turns{3, 4, 5});
    }
    CHECK(reorder.empty());
    CHECK(reorder.missing() == 0);
}

TEST_CASE("reorder: results of an earlier run do not go before those that wait for a turn that never comes")
{
    Reorder reorder(30s);
    for (const std::int64_t of : {1, 4, 6})
        reorder.push(redone(of, of, 7), start);
    reorder.push(redone(5, 3, 8), start);  // the first turn of this run was answered in the earlier one
    reorder.push(redone(3, 2, 8), start);
    CHECK(sequences(reorder) == Turns{1});
    CHECK(reorder.deadline() == start + 30s);
    reorder.finish(start + 1s);
    const auto due = start + 1s + Reorder::closed_timeout;
    CHECK(reorder.deadline() == due);
    reorder.expire(due);
    CHECK(sequences(reorder) == Turns{3, 4, 5, 6});
    CHECK(reorder.empty());
}

TEST_CASE("reorder: a turn of which one result was refused as a second answer may have another one")
{
    Reorder reorder(30s);
    push(reorder, {1});
    reorder.skip(identity(2), start);
    push(reorder, {4}, {.part = 1});
    reorder.skip(identity(4), start);
    CHECK(push(reorder, {2}, {.part = 1}));
    push(reorder, {3});
    CHECK(drain(reorder) == Turns{1, 2, 3, 4});
    CHECK(reorder.missing() == 0);
}

TEST_CASE("reorder: a reported failure takes the place of its result, early or late")
{
    Reorder reorder(30s);
    push(reorder, {1, 3});
    reorder.fail(identity(2), start);
    CHECK(drain(reorder) == Turns{1, 3});
    reorder.fail(identity(5), start);
    push(reorder, {6, 4});
    CHECK(drain(reorder) == Turns{4, 6});
    CHECK(reorder.failed() == 2);
    CHECK(reorder.missing() == 0);
}

TEST_CASE("reorder: a turn fails once, whichever stages report it, and never after its result")
{
    Reorder reorder(30s);
    push(reorder, {1});
    auto by_a_later_stage = identity(2);
    by_a_later_stage.shares.push_back({.of = "face.crops#ages", .epoch = 4, .turn = 77});
    reorder.fail(by_a_later_stage, start);
    reorder.fail(identity(2), start);
    reorder.fail(identity(1), start);
    push(reorder, {4});
    reorder.fail(identity(4), start);
    CHECK(reorder.failed() == 1);
    push(reorder, {3});
    CHECK(drain(reorder) == Turns{1, 3, 4});
}

TEST_CASE("reorder: a result of a turn that had failed or was given up comes too late and is left out")
{
    Reorder reorder(30s);
    push(reorder, {1, 4});
    reorder.fail(identity(2), start);
    reorder.expire(start + 30s);
    CHECK(drain(reorder) == Turns{1, 4});
    CHECK_FALSE(push(reorder, {2}, {}, start + 31s));
    CHECK_FALSE(push(reorder, {3}, {}, start + 31s));
    CHECK(push(reorder, {5}, {}, start + 31s));
    CHECK(drain(reorder) == Turns{5});
    CHECK(reorder.missing() == 1);
    CHECK(reorder.failed() == 1);
}

TEST_CASE("reorder: of live results 64 wait at most")
{
    Reorder reorder(30s);
    push(reorder, {1}, {.lossless = false});
    for (std::int64_t turn = 3; turn < 3 + static_cast<std::int64_t>(Reorder::live_window); ++turn)
        push(reorder, {turn}, {.lossless = false});
    reorder.expire(start);
    CHECK(drain(reorder) == Turns{1});
    push(reorder, {3 + static_cast<std::int64_t>(Reorder::live_window)}, {.lossless = false});
    reorder.expire(start);
    CHECK(drain(reorder).size() == Reorder::live_window + 1);
    CHECK(reorder.missing() == 1);
}

TEST_CASE("reorder: what nobody shares comes as it came")
{
    Reorder reorder(30s);
    for (const auto sequence : {5, 14, 9}) {
        Event event;
        event.identity = {.source = "camera", .epoch = 1, .sequence = sequence, .lossless = sequence == 14};
        CHECK(reorder.push(std::move(event), start));
    }
    CHECK(drain(reorder) == Turns{5, 14, 9});
    reorder.fail({.source = "camera", .epoch = 1, .sequence = 15}, start);
    CHECK(reorder.failed() == 1);
    CHECK_FALSE(reorder.deadline());
}

TEST_CASE("reorder: who joins in the middle waits for what a worker has in hand, as for any other turn")
{
    Reorder reorder(30s);
    reorder.expect(standing(12, 9), {10, 12});
    const Made live{.closed = 9, .lossless = false};
    push(reorder, {13, 12}, live);
    reorder.expire(start + 29s);
    CHECK(drain(reorder).empty());
    push(reorder, {10}, live, start + 29s);
    CHECK(drain(reorder) == Turns{10});
    // Turn 11 was given out before this began to receive, and no worker has it: its result went elsewhere.
    reorder.expire(start + 29s + Reorder::join_timeout - 1ns);
    CHECK(drain(reorder).empty());
    reorder.expire(start + 29s + Reorder::join_timeout);
    CHECK(drain(reorder) == Turns{12, 13});
    CHECK(reorder.missing() == 0);
}

TEST_CASE("reorder: a lossless turn that no worker seemed to have in hand comes, or is closed soon")
{
    Reorder reorder(30s);
    reorder.expect(standing(12, 9), {});
    push(reorder, {12}, {.closed = 9});
    reorder.expire(start + 29s);
    CHECK(drain(reorder).empty());
    CHECK(push(reorder, {11}, {.closed = 9}, start + 29s));  // dispatched after its worker had reported
    CHECK(drain(reorder).empty());
    push(reorder, {13}, {.closed = 10}, start + 29s);
    reorder.expire(start + 29s);
    CHECK(drain(reorder) == Turns{11, 12, 13});
    CHECK(reorder.missing() == 0);
}

TEST_CASE("reorder: a result is awaited from the time on when a later one waits for it")
{
    for (const bool lossless : {true, false}) {
        Reorder reorder(1s);
        push(reorder, {1}, {.lossless = lossless});
        push(reorder, {3}, {.lossless = lossless}, start + 10s);  // two workers, an event each 10 s
        reorder.expire(start + 11s - 1ns);
        CHECK(drain(reorder) == Turns{1});
        push(reorder, {2}, {.lossless = lossless}, start + 11s - 1ns);
        CHECK(drain(reorder) == Turns{2, 3});
    }
}

TEST_CASE("reorder: a live turn that a worker had in hand when this joined is missing when it never comes")
{
    Reorder reorder(1s);
    reorder.expect(standing(3, 1), {2});
    push(reorder, {4}, {.closed = 1, .lossless = false});
    reorder.expire(start + 1s - 1ns);
    CHECK(drain(reorder).empty());
    reorder.expire(start + 1s);
    CHECK(drain(reorder) == Turns{4});
    CHECK(reorder.missing() == 1);  // turn 3 nobody had, so its result went elsewhere
    CHECK(reorder.missing_turns().at("camera.image#workers") == Turns{2});
}

TEST_CASE("reorder: what several workers tell is put together")
{
    Reorder reorder(30s);
    reorder.expect(standing(11, 8), {9});
    reorder.expect(standing(12, 8), {10, 12});
    push(reorder, {13, 12, 10}, {.closed = 8});
    CHECK(drain(reorder).empty());
    push(reorder, {9}, {.closed = 8});
    CHECK(drain(reorder) == Turns{9, 10});
    push(reorder, {11}, {.closed = 8});
    CHECK(drain(reorder) == Turns{11, 12, 13});
}

TEST_CASE("reorder: without a word from the workers the first result says what may still come")
{
    Reorder reorder(30s);
    push(reorder, {1001}, {.closed = 999});
    CHECK(drain(reorder).empty());
    push(reorder, {1000}, {.closed = 999});
    CHECK(drain(reorder) == Turns{1000, 1001});
    CHECK(reorder.missing() == 0);
}

TEST_CASE("reorder: what another stage still has in hand of live turns from before the first result is left out")
{
    Reorder reorder(30s);
    CHECK(push(reorder, {30, 31}, {.closed = 29, .lossless = false}));
    CHECK_FALSE(push(reorder, {2}, {.closed = 31, .lossless = false}));
    CHECK(push(reorder, {32}, {.closed = 31, .lossless = false}));
    CHECK(drain(reorder) == Turns{30, 31, 32});
    CHECK(reorder.missing() == 0);
}

TEST_CASE("reorder: two outputs of one turn both come, also when they had to wait, and further parts as they come")
{
    Reorder reorder(30s);
    push(reorder, {1, 3, 3});
    CHECK(drain(reorder) == Turns{1});
    push(reorder, {2});
    CHECK(drain(reorder) == Turns{2, 3, 3});
    push(reorder, {3}, {.part = 1});
    CHECK(drain(reorder) == Turns{3});
}

TEST_CASE("reorder: groups and the epochs of their senders are apart")
{
    Reorder reorder(30s);
    push(reorder, {1, 2});
    push(reorder, {1}, {.epoch = 2});
    push(reorder, {2}, {.of = "camera.edges#workers"});
    CHECK(drain(reorder) == Turns{1, 2, 1});
    push(reorder, {1}, {.of = "camera.edges#workers"});
    CHECK(drain(reorder) == Turns{1, 2});
}

TEST_CASE("reorder: of nested stages the outermost group gives the order")
{
    Reorder reorder(30s);
    for (const std::int64_t turn : {2, 1}) {
        Event event;
        event.identity = identity(turn);
        event.identity.shares.push_back({.of = "face.crops#ages", .epoch = 4, .turn = 3 - turn});
        reorder.push(std::move(event), start);
    }
    CHECK(drain(reorder) == Turns{1, 2});
}

TEST_CASE("reorder: when nothing more will come, what is missing is waited for a moment longer and no more")
{
    Reorder reorder(30s);
    push(reorder, {1, 3});
    CHECK(drain(reorder) == Turns{1});
    reorder.finish(start + 5s);
    CHECK_FALSE(reorder.empty());
    reorder.expire(start + 5s);
    CHECK(drain(reorder).empty());  // an exception may come
    reorder.expire(start + 5s + Reorder::closed_timeout);
    CHECK(drain(reorder) == Turns{3});
    CHECK(reorder.empty());
    CHECK(reorder.missing() == 0);  // all turns are closed before the end
}

}  // namespace hive
