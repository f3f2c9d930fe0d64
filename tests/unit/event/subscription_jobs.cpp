// Leases, and turns that are closed once: by the first answer, or by being given up when nobody can answer any more.
#include "workers.hpp"

#include <doctest/doctest.h>

namespace hive::event {

using namespace std::chrono_literals;

TEST_CASE("job: a lease that expires gives the event to another")
{
    Workers workers(2, sharing(500ms));
    workers.offer(1);
    CHECK(workers.pass(499ms).empty());
    CHECK(workers.pass(1ms) == Got{{2, {1}}});
    CHECK(workers.last_share->attempt == 2);
    CHECK(workers.members["face-1"].ledger.of(Fate::passed_on) == 1);
    CHECK(workers.all_balanced());
}

TEST_CASE("job: a member whose lease expired gets nothing more until it answers, and says why")
{
    Workers workers(2, sharing(500ms));
    workers.offer(1);
    workers.pass(500ms);
    CHECK(workers.offer(2).empty());
    CHECK(workers.subscription.why() == Reason::lease_running);
    CHECK(workers.subscription.why(1) == Reason::lease_running);
    CHECK(workers.done(1, 1) == Got{{1, {2}}});
    CHECK(workers.subscription.why(1) == Reason::not_asked);
}

TEST_CASE("job: the first answer closes it, whoever gives it, and later ones count for nothing")
{
    for (const ReceiverId first : {1, 2, 3}) {
        Workers workers(3, sharing(500ms));
        workers.offer(1);
        workers.pass(500ms);
        workers.pass(500ms);
        CHECK(workers.last_share->attempt == 3);
        workers.done(first, 1);
        CHECK(workers.went(Fate::acknowledged) == 1);
        CHECK(workers.subscription.standing().closed == 1);
        for (const ReceiverId other : {1, 2, 3})
            if (other != first)
                CHECK(workers.done(other, 1).empty());
        CHECK(workers.went(Fate::acknowledged) == 1);
        CHECK(workers.ledger().in_flight() == 0);
        CHECK(workers.failed.empty());
        CHECK(workers.all_balanced());
    }
}

TEST_CASE("job: an answer also closes one that waits to be given out again")
{
    Workers workers(1, sharing(500ms));
    workers.offer(1);
    workers.pass(500ms);
    CHECK(workers.subscription.backlogged());
    CHECK(workers.done(1, 1).empty());
    CHECK_FALSE(workers.subscription.backlogged());
    CHECK(workers.went(Fate::acknowledged) == 1);
    CHECK(workers.all_balanced());
}

TEST_CASE("job: nothing is given up while anybody holds an attempt, the last or an earlier one")
{
    Workers workers(3, sharing(500ms));
    workers.offer(1);
    for (int lease = 1; lease <= 10; ++lease)
        workers.pass(500ms);
    CHECK(workers.last_share->attempt == 3);
    CHECK(workers.failed.empty());
    CHECK(workers.ledger().in_flight() == 1);
    CHECK(workers.subscription.why() == Reason::lease_running);
    CHECK(workers.lose(3).empty());
    CHECK(workers.lose(1).empty());
    CHECK(workers.failed.empty());  // the second of them may still answer
    workers.done(2, 1);
    CHECK(workers.went(Fate::acknowledged) == 1);
    CHECK(workers.failed.empty());
}

TEST_CASE(
    "job: it is given up when the last of those who could answer will not return, and said so with turn and attempt")
{
    Workers workers(4, sharing(500ms));
    workers.offer(1);
    for (int lease = 1; lease <= 3; ++lease)
        workers.pass(500ms);
    workers.lose(1);
    workers.lose(2, Fate::lost_cut_off);
    CHECK(workers.failed.empty());
    CHECK(workers.lose(3).empty());
    CHECK(workers.failed.empty());
    CHECK(workers.subscription.why() == Reason::none);
    decided([&](Decisions& to) { workers.subscription.end(workers.now, to); });
    CHECK(workers.subscription.why() == Reason::lease_running);  // for the end waits
    decided([&](Decisions& to) { workers.subscription.go_on(to); });
    CHECK(workers.forget("face-2").empty());
    CHECK(workers.failed == Sequences{1});
    REQUIRE(workers.last_failed);
    CHECK(*workers.last_failed
          == Share{.of = "camera.image#workers", .epoch = 1, .turn = 1, .attempt = 3, .closed = 0});
    CHECK(workers.went(Fate::abandoned) == 1);
    CHECK(workers.offer(2) == Got{{4, {2}}});
    CHECK(workers.last_share->closed == 1);
    CHECK(workers.all_balanced());
}

TEST_CASE("job: one that three members died of is given up when none of them can return")
{
    Workers workers(4);
    workers.offer(1);
    CHECK(workers.lose(1) == Got{{2, {1}}});
    CHECK(workers.lose(2, Fate::lost_cut_off) == Got{{3, {1}}});
    CHECK(workers.failed.empty());
    CHECK(workers.lose(3).empty());
    CHECK(workers.failed.empty());
    CHECK(workers.join(5, "face-2").empty());
    CHECK(workers.failed == Sequences{1});
}

TEST_CASE("job: a member that is at work again is not given once more what it has in hand, others are")
{
    for (const bool another : {true, false}) {
        Workers workers(1, sharing(500ms, 2));
        workers.offer(1);
        workers.offer(2);
        workers.pass(500ms);
        CHECK(workers.ask(1, {3, 1, 1}).empty());
        CHECK(workers.offer(3) == Got{{1, {3}}});
        if (another)
            CHECK(workers.join(2) == Got{{2, {2}}});
        workers.ask(1, {5, 3, 3});
        CHECK(workers.went(Fate::acknowledged) == 3);
        CHECK(workers.ledger().in_flight() == 0);
        CHECK(workers.all_balanced());
    }
}

TEST_CASE("job: a connection that breaks, a member that leaves and one that hands back are no failures of the work")
{
    Workers workers(2);
    workers.offer(1);
    for (int round = 1; round <= 10; ++round) {
        CHECK(workers.ask(1, {1, 0, 0}, {1}) == Got{{2, {1}}});
        workers.leave(1);
        CHECK(workers.join(1).empty());
        CHECK(workers.lose(2, Fate::lost_connection) == Got{{1, {1}}});
        workers.join(2);
        CHECK(workers.leave(1) == Got{{2, {1}}});
        workers.join(1);
        CHECK(workers.ask(2, {1, 0, 0}, {1}) == Got{{1, {1}}});
        workers.leave(2);
        workers.join(2);
    }
    CHECK(workers.failed.empty());
    CHECK(workers.went(Fate::abandoned) == 0);
    workers.done(1, 1);
    CHECK(workers.went(Fate::acknowledged) == 1);
}

TEST_CASE("job: what a dying member had not begun is no failure of it")
{
    Workers workers(1, sharing(2));
    workers.offer(1);
    workers.offer(2);
    for (ReceiverId id = 1; id <= 3; ++id) {
        CHECK(workers.failed.empty());
        workers.join(id + 1);
        CHECK(workers.lose(id) == Got{{id + 1, id < 3 ? Sequences{1, 2} : Sequences{2}}});
    }
    CHECK(workers.failed == Sequences{1});
    for (ReceiverId id = 4; id <= 5; ++id) {
        workers.join(id + 1);
        CHECK(workers.lose(id) == Got{{id + 1, {2}}});
    }
    CHECK(workers.failed == Sequences{1});
}

TEST_CASE("job: the lease of queued work begins when it becomes the member's next")
{
    Workers workers(1, sharing(500ms, 2));
    workers.offer(1);
    workers.offer(2);
    workers.pass(400ms);
    workers.done(1, 1, 2);
    CHECK(workers.pass(499ms).empty());
    CHECK(workers.ledger().in_flight() == 1);
    CHECK_FALSE(workers.subscription.backlogged());
    workers.pass(1ms);
    CHECK(workers.subscription.backlogged());
}

TEST_CASE("job: the lease runs while the member works, not while its result is on its way")
{
    Workers workers(2, sharing(500ms));
    workers.offer(1);
    workers.pass(400ms);
    workers.ask(1, {1, 1, 0});  // worked on; what was made of it is not yet acknowledged
    CHECK_FALSE(workers.subscription.timed());
    CHECK(workers.pass(10s).empty());
    CHECK(workers.ledger().in_flight() == 1);
    CHECK(workers.lose(1) == Got{{2, {1}}});  // it could never acknowledge it
    CHECK(workers.last_share->attempt == 2);
}

TEST_CASE("job: a member that dies after it has worked did not die of the work")
{
    Workers workers(1);
    workers.offer(1);
    for (ReceiverId id = 1; id <= 5; ++id) {
        workers.ask(id, {1, 1, 0});
        workers.lose(id);
        CHECK(workers.join(id + 1) == Got{{id + 1, {1}}});
    }
    CHECK(workers.failed.empty());
}

TEST_CASE("job: the lease follows from how long the work has taken")
{
    Workers workers(2);
    for (int i = 1; i <= 3; ++i) {
        workers.offer(i);
        workers.now += 1s;
        workers.done(i % 2 == 1 ? 1 : 2, (i + 1) / 2);
    }
    workers.offer(4);
    CHECK(workers.pass(3900ms).empty());
    CHECK_FALSE(workers.pass(200ms).empty());
}

}  // namespace hive::event
