// Who gets a job: one member each, in turns without gaps, and what becomes of the work of members that go.
#include "workers.hpp"

#include <doctest/doctest.h>

namespace hive::event {

using namespace std::chrono_literals;

TEST_CASE("shared: each event goes to exactly one member, the one that has waited longest")
{
    Workers workers(3);
    CHECK(workers.offer(1) == Got{{1, {1}}});
    CHECK(workers.offer(2) == Got{{2, {2}}});
    CHECK(workers.offer(3) == Got{{3, {3}}});
    CHECK(workers.offer(4).empty());
    CHECK(workers.done(2, 1) == Got{{2, {4}}});
    workers.done(3, 1);
    workers.done(1, 1);
    CHECK(workers.offer(5) == Got{{3, {5}}});
    CHECK(workers.offer(6) == Got{{1, {6}}});
}

TEST_CASE("shared: with a window, an idle member comes before one that has work")
{
    Workers workers(2, sharing(2));
    CHECK(workers.offer(1) == Got{{1, {1}}});
    CHECK(workers.offer(2) == Got{{2, {2}}});
    CHECK(workers.offer(3) == Got{{1, {3}}});
    CHECK(workers.offer(4) == Got{{2, {4}}});
    CHECK(workers.offer(5).empty());
    CHECK(workers.subscription.why() == Reason::not_asked);
    CHECK(workers.subscription.why(1) == Reason::not_asked);
}

TEST_CASE("shared: among live events one that is lossless is not replaced")
{
    Workers workers(1);
    CHECK(workers.offer(1, false) == Got{{1, {1}}});
    workers.offer(2, true);
    workers.offer(3, false);
    workers.offer(4, false);
    CHECK(workers.done(1, 1) == Got{{1, {2}}});
    CHECK(workers.done(1, 2) == Got{{1, {4}}});
    CHECK(workers.all_balanced());
}

TEST_CASE("shared: a live source keeps the newest for the next free member, and turns have no gap where it skips")
{
    Workers workers(1);
    workers.offer(1, false);
    workers.offer(2, false);
    workers.offer(3, false);
    CHECK(workers.done(1, 1) == Got{{1, {3}}});
    CHECK(workers.last_share->turn == 2);
    CHECK(workers.went(Fate::skipped) == 1);
    CHECK(workers.all_balanced());
}

TEST_CASE("shared: a member is told whose work it is, and how far the turns are closed")
{
    Workers workers(2);
    workers.offer(1);
    CHECK(*workers.last_share == Share{.of = "camera.image#workers", .epoch = 1, .turn = 1, .attempt = 1});
    workers.offer(2);
    workers.done(2, 1);
    workers.offer(3);
    CHECK(workers.last_share->closed == 0);  // the first is still being worked on
    workers.done(1, 1);
    workers.offer(4);
    CHECK(workers.last_share->turn == 4);
    CHECK(workers.last_share->closed == 2);
    CHECK(workers.subscription.standing() == Share{.of = "camera.image#workers", .epoch = 1, .turn = 4, .closed = 2});
}

TEST_CASE("shared: the work of a member that is gone goes to another as the next attempt")
{
    Workers workers(2);
    workers.offer(1);
    workers.offer(2);
    workers.done(2, 1);
    CHECK(workers.lose(1) == Got{{2, {1}}});
    CHECK(workers.last_share->attempt == 2);
    CHECK(workers.last_share->turn == 1);
    CHECK(workers.members["face-1"].ledger.of(Fate::passed_on) == 1);
    CHECK(workers.all_balanced());
}

TEST_CASE("shared: a member that comes back has its work again, unless another has got it, and answers for that too")
{
    Workers workers(2, sharing(2));
    for (const int number : {1, 2, 3, 4, 5})
        workers.offer(number);  // 1, 3 to the first; 2, 4 to the second
    workers.ask(2, {3, 1, 1});  // it gets 5, too
    CHECK(workers.lose(1, Fate::lost_connection).empty());
    CHECK(workers.done(2, 2, 2) == Got{{2, {1}}});
    SUBCASE("and has got both")
    {
        CHECK(workers.resume(3, "face-1", 2, 2).empty());
        CHECK(workers.subscription.waiting() == 0);  // 3 is its own again
        workers.done(3, 2, 2);
        CHECK(workers.went(Fate::acknowledged) == 4);
        CHECK(workers.members["face-1"].ledger.of(Fate::acknowledged) == 1);
        workers.done(2, 4, 2);
        CHECK(workers.went(Fate::acknowledged) == 5);
    }
    SUBCASE("and has got one")
    {
        CHECK(workers.resume(3, "face-1", 1, 0) == Got{{3, {3}}});
        workers.done(3, 2, 2);
        CHECK(workers.went(Fate::acknowledged) == 4);
    }
    SUBCASE("and has restarted")
    {
        CHECK(workers.join(3, "face-1") == Got{{3, {3}}});
        workers.done(3, 1, 2);
        CHECK(workers.went(Fate::acknowledged) == 3);
    }
    CHECK(workers.all_balanced());
}

TEST_CASE(
    "shared: a member that is back before its loss is noticed keeps its work, and an event on the way goes out again")
{
    Workers workers(1, sharing(2));
    workers.offer(1);
    workers.offer(2);
    workers.join(2);
    CHECK(workers.resume(3, "face-1", 1, 1) == Got{{2, {2}}});
    CHECK(workers.members["face-1"].ledger.of(Fate::passed_on) == 1);
    workers.done(3, 1, 2);
    workers.done(2, 1, 2);
    CHECK(workers.went(Fate::acknowledged) == 2);
    CHECK(workers.all_balanced());
}

TEST_CASE("shared: an event that never reached a member that comes back has not failed there")
{
    Workers workers(3);
    workers.offer(1);
    workers.lose(1);
    workers.lose(2);
    workers.lose(3, Fate::lost_cut_off);
    CHECK(workers.resume(4, "face-3", 0, 0) == Got{{4, {1}}});
    CHECK(workers.failed.empty());
}

TEST_CASE("shared: a member whose lease expired does not get its work back, nor more, by a new connection")
{
    Workers workers(1, sharing(500ms, 2));
    workers.offer(1);
    workers.offer(2);
    workers.pass(500ms);
    workers.lose(1, Fate::lost_connection);
    workers.resume(2, "face-1", 2, 2);
    CHECK(workers.subscription.waiting() == 2);
    CHECK(workers.join(3, "face-2") == Got{{3, {1, 2}}});
    workers.offer(3);
    CHECK(workers.ask(2, {3, 1, 1}) == Got{{2, {3}}});
}

TEST_CASE("shared: the lease of a member does not run while it is away")
{
    Workers workers(1, sharing(500ms, 2));
    workers.offer(1);
    workers.pass(300ms);
    workers.lose(1, Fate::lost_connection);
    workers.pass(3s);
    workers.resume(2, "face-1", 1, 1);
    workers.join(3, "face-2");
    CHECK(workers.pass(100ms).empty());
    CHECK(workers.pass(100ms) == Got{{3, {1}}});
}

TEST_CASE("shared: an event that was answered while it was on the way to a member is none that it has in hand")
{
    Workers workers(2, sharing(500ms));
    workers.offer(1);
    CHECK(workers.pass(500ms) == Got{{2, {1}}});
    workers.done(1, 1);
    workers.resume(3, "face-2", 0, 0);
    CHECK(workers.members["face-2"].ledger.in_flight() == 0);
    CHECK(workers.all_balanced());
}

TEST_CASE("shared: the other members get the end when the sender stops waiting for a lost one")
{
    Workers workers(4);
    workers.offer(1);
    workers.lose(1);
    workers.lose(2);
    workers.lose(3, Fate::lost_cut_off);
    CHECK(decided([&](Decisions& to) { workers.subscription.end(workers.now, to); }).ends.empty());
    const auto over =
        decided([&](Decisions& to) { workers.subscription.forget_away(workers.members["face-3"], workers.now, to); });
    CHECK(over.failed.size() == 1);
    CHECK(over.ends == std::vector<ReceiverId>{4});
}

TEST_CASE("shared: without leases the work of a member that is gone is lost")
{
    Workers workers(2, sharing(), false);
    workers.offer(1);
    workers.offer(2);
    workers.done(2, 1);
    CHECK(workers.lose(1).empty());
    CHECK(workers.went(Fate::abandoned) == 1);
    CHECK(workers.failed.empty());
}

TEST_CASE("shared: what the last member returned waits until it has acknowledged the rest, and says so")
{
    Workers workers(1, sharing(3));
    for (const int number : {1, 2, 3})
        workers.offer(number);
    workers.subscription.retire(1);
    CHECK(workers.subscription.why() == Reason::none);
    workers.ask(1, {3, 0, 0}, {2, 3});
    CHECK(workers.subscription.waiting() == 2);
    CHECK(workers.subscription.why() == Reason::not_acknowledged);
    workers.done(1, 3);
    workers.lose(1, Fate::lost_connection);
    CHECK(workers.subscription.why() == Reason::group_awaited);
}

TEST_CASE("shared: an event is not given up while a member that leaves still works on it")
{
    Workers workers(1, sharing(2));
    workers.offer(1);
    workers.subscription.retire(1);
    workers.join(2);  // the same drone with other options
    workers.offer(2);
    workers.leave(2);
    CHECK(workers.failed == Sequences{2});
    SUBCASE("and acknowledges it")
    {
        workers.done(1, 1, 2);
        CHECK(workers.went(Fate::acknowledged) == 1);
        workers.leave(1);
        CHECK(workers.failed == Sequences{2});
    }
    SUBCASE("and leaves without an answer")
    {
        workers.leave(1);
        CHECK(workers.failed == Sequences{2, 1});
    }
    SUBCASE("and crashes: it may have answered")
    {
        workers.lose(1);
        CHECK(workers.failed == Sequences{2});
        CHECK(workers.subscription.why() == Reason::group_awaited);
    }
    CHECK(workers.all_balanced());
}

TEST_CASE("shared: what was taken back goes out before newer events, in its order")
{
    Workers workers(2, sharing(2));
    for (int i = 1; i <= 4; ++i)
        workers.offer(i);  // 1, 3 to the first; 2, 4 to the second
    workers.offer(5);
    CHECK(workers.lose(1).empty());
    CHECK(workers.done(2, 1, 2) == Got{{2, {1}}});
    CHECK(workers.done(2, 2, 2) == Got{{2, {3}}});
    CHECK(workers.done(2, 3, 2) == Got{{2, {5}}});
}

TEST_CASE("shared: what a member hands back goes to others, and it answers for the rest as before")
{
    Workers workers(2, sharing(3));
    for (int i = 1; i <= 6; ++i)
        workers.offer(i);  // 1, 3, 5 to the first; 2, 4, 6 to the second
    workers.done(2, 3, 3);
    // It halts: of three deliveries it has begun one.
    CHECK(workers.ask(1, {3, 0, 0}, {2, 3}) == Got{{2, {3, 5}}});
    CHECK(workers.last_share->attempt == 2);
    CHECK(workers.members["face-1"].ledger.of(Fate::passed_on) == 2);
    // What it handed back counts in its numbers and closes no turn.
    workers.ask(1, {3, 3, 3});
    CHECK(workers.members["face-1"].ledger.of(Fate::acknowledged) == 1);
    CHECK(workers.subscription.standing().closed == 2);
    workers.done(2, 5, 3);
    CHECK(workers.subscription.standing().closed == 6);
    CHECK(workers.went(Fate::acknowledged) == 6);
    CHECK(workers.all_balanced());
}

TEST_CASE("shared: numbers handed back that a member was never sent, or has done, change nothing")
{
    Workers workers(2, sharing(2));
    workers.offer(1);
    workers.offer(2);
    workers.done(1, 1, 2);
    CHECK(workers.ask(1, {3, 1, 1}, {1, 2, 99, -7, 0}).empty());
    CHECK(workers.went(Fate::acknowledged) == 1);
    CHECK(workers.ask(2, {2, 0, 0}, {1, 1, 1}) == Got{{1, {2}}});
    CHECK(workers.members["face-2"].ledger.of(Fate::passed_on) == 1);
    CHECK(workers.all_balanced());
}

TEST_CASE(
    "shared: the shortest lease that a member asks for holds for all, or the measured one if a member asks for none")
{
    auto greedy = sharing();
    greedy.lease = 24h;
    Workers workers(0);
    workers.join(1, "greedy", greedy);
    CHECK(workers.offer(1) == Got{{1, {1}}});
    CHECK(workers.pass(1h).empty());
    workers.join(2, "face");
    CHECK(workers.pass(1s) == Got{{2, {1}}});  // 30 s, and the job is an hour old
    auto modest = greedy;
    modest.lease = 5s;
    Workers others(0);
    others.join(1, "greedy", greedy);
    others.join(2, "modest", modest);
    CHECK(others.offer(1) == Got{{1, {1}}});
    CHECK(others.pass(4s).empty());
    CHECK(others.pass(1s) == Got{{2, {1}}});
}

TEST_CASE("shared: members join and leave while it runs, and leases of others stay where they are")
{
    Workers workers(1);
    workers.offer(1);
    CHECK(workers.offer(2).empty());
    CHECK(workers.join(2) == Got{{2, {2}}});
    workers.leave(2);
    CHECK(workers.done(1, 1) == Got{{1, {2}}});
}

TEST_CASE("shared: work of a source on demand waits for a crashed last member to come back")
{
    Workers workers(1);
    workers.offer(1);
    workers.lose(1);
    CHECK(workers.subscription.awaited());
    CHECK(workers.subscription.why() == Reason::group_awaited);
    CHECK_FALSE(workers.subscription.asks());
    CHECK(workers.join(7, "face-1") == Got{{7, {1}}});
    CHECK_FALSE(workers.subscription.awaited());
}

TEST_CASE("shared: a source on demand also waits when the crashed member had nothing left to do")
{
    Workers workers(1);
    workers.offer(1);
    workers.done(1, 1);
    workers.lose(1);
    CHECK(workers.subscription.awaited());
}

TEST_CASE("shared: who need not be waited for is forgotten, and what waited for it is given up")
{
    Workers workers(1);
    workers.offer(1);
    workers.offer(2);
    workers.lose(1);
    workers.forget();
    CHECK_FALSE(workers.subscription.active());
    CHECK(workers.failed == Sequences{2});
    CHECK(workers.went(Fate::abandoned) == 1);
    CHECK(workers.subscription.why() == Reason::group_awaited);  // event 1, which the lost member may have answered
    CHECK_FALSE(workers.subscription.backlogged());
    CHECK(workers.join(7, "face-1") == Got{{7, {1}}});
    CHECK(workers.done(7, 1).empty());
    CHECK(workers.offer(3) == Got{{7, {3}}});
    CHECK(workers.last_share->turn == 2);
    CHECK(workers.last_share->closed == 1);
    CHECK(workers.all_balanced());
}

TEST_CASE("shared: work of a live source waits for a crashed last member too, without costing the source anything")
{
    Workers workers(1);
    workers.offer(1, false);
    workers.done(1, 1);
    workers.offer(2, false);
    workers.offer(3, false);
    workers.lose(1);
    CHECK_FALSE(workers.subscription.active());
    CHECK_FALSE(workers.subscription.backlogged());
    CHECK(workers.went(Fate::skipped) == 1);  // event 3
    CHECK(workers.ledger().in_flight() == 1);
    CHECK(workers.join(7, "face-1") == Got{{7, {2}}});
    CHECK(workers.last_share->attempt == 2);
    CHECK(workers.done(7, 1).empty());
    CHECK(workers.all_balanced());
}

TEST_CASE("shared: turns go on after the group was without members, so that results can still be put in order")
{
    for (const bool left : {true, false}) {
        Workers workers(1);
        workers.offer(1, false);
        workers.done(1, 1);
        workers.offer(2, false);
        workers.done(1, 2);
        left ? workers.leave(1) : workers.lose(1);
        workers.join(7, "face-1");
        CHECK(workers.offer(3, false) == Got{{7, {3}}});
        CHECK(workers.last_share->turn == 3);
    }
}

TEST_CASE("shared: the last member that leaves on purpose ends the work: what is left of it is given up and said so")
{
    Workers workers(1, sharing(2));
    workers.offer(1);
    workers.offer(2);
    workers.offer(3);
    workers.leave(1);
    CHECK_FALSE(workers.subscription.active());
    CHECK_FALSE(workers.subscription.backlogged());
    CHECK(workers.failed == Sequences{1, 2, 3});
    CHECK(workers.join(2).empty());
    CHECK(workers.went(Fate::abandoned) == 3);
    CHECK(workers.all_balanced());
}

TEST_CASE("shared: the last member that leaves on purpose ends no work that a lost one may have answered")
{
    Workers workers(2, sharing(1));
    workers.offer(1);
    workers.offer(2);
    workers.lose(1);
    workers.leave(2);
    CHECK(workers.failed == Sequences{2});
    CHECK_FALSE(workers.subscription.active());
    CHECK(workers.join(7, "face-1") == Got{{7, {1}}});  // the next attempt is in doubt for the same reason
    workers.leave(7);
    CHECK(workers.failed == Sequences{2});
    CHECK(workers.join(8) == Got{{8, {1}}});
    CHECK(workers.done(8, 1).empty());
    CHECK(workers.all_balanced());
}

TEST_CASE("shared: when there will be no next member, what is in doubt is given up as well")
{
    Workers workers(1);
    workers.offer(1);
    workers.lose(1);
    workers.forget();
    CHECK(workers.failed.empty());
    workers.give_up();
    CHECK(workers.failed == Sequences{1});
    CHECK(workers.all_balanced());
}

}  // namespace hive::event
