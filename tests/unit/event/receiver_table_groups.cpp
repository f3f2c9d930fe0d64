// The receiver table with groups: one job, several workers, leases.
#include "fixtures.hpp"

#include <doctest/doctest.h>

#include <map>

namespace hive::event {
namespace {

using namespace std::chrono_literals;

/// Workers 1 to n in one group, and a transport that writes at once.
struct Workers {
    explicit Workers(int count, const ConnectionOptions& options = sharing(), ReceiverTable::Defences defences = {true})
        : table(defences)
    {
        for (int id = 1; id <= count; ++id)
            table.add(static_cast<ReceiverTable::Id>(id), "face-" + std::to_string(id), epoch, options, now);
    }
    /// Worker -> sequences it got, with what writing set free.
    std::map<ReceiverTable::Id, Sequences> got(const ReceiverTable::Decisions& decisions)
    {
        std::map<ReceiverTable::Id, Sequences> result;
        for (const auto& send : decisions.sends) {
            result[send.receiver].push_back(send.event->event().identity.sequence);
            last_attempt = send.share.attempt;
            last_turn = send.share.turn;
            for (const auto& [id, more] : got(table.written(send.receiver, send.event->size(), now)))
                result[id].insert(result[id].end(), more.begin(), more.end());
        }
        for (const auto& event : decisions.failed) {
            failed.push_back(event->event().identity.sequence);
            failed_turns.push_back(event->event().identity.turn);
            last_failed = event->event().identity;
        }
        return result;
    }
    auto offer(std::int64_t sequence, bool lossless = true)
    {
        return got(table.offer(emission(sequence, lossless), false, now));
    }
    auto done(ReceiverTable::Id id, std::int64_t count, int size = 1)
    {
        return got(table.request(id, epoch, count + size, count, now));
    }
    auto pass(Clock::duration time)
    {
        now += time;
        return got(table.tick(now));
    }
    [[nodiscard]] Counts group() const { return table.rows().back().counts; }

    ReceiverTable table;
    Clock::time_point now = start;
    Sequences failed, failed_turns;
    Identity last_failed;
    int last_attempt = 0;
    std::int64_t last_turn = 0;
};

using Got = std::map<ReceiverTable::Id, Sequences>;

}  // namespace

TEST_CASE("group: each event goes to exactly one member, the one that has waited longest")
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

TEST_CASE("group: with a window, an idle member comes before one that has work")
{
    Workers workers(2, sharing(2));
    CHECK(workers.offer(1) == Got{{1, {1}}});
    CHECK(workers.offer(2) == Got{{2, {2}}});
    CHECK(workers.offer(3) == Got{{1, {3}}});
    CHECK(workers.offer(4) == Got{{2, {4}}});
    CHECK(workers.offer(5).empty());
}

TEST_CASE("group: among live events one that is lossless is not replaced")
{
    Workers workers(1);
    CHECK(workers.offer(1, false) == Got{{1, {1}}});
    workers.offer(2, true);
    workers.offer(3, false);
    workers.offer(4, false);
    CHECK(workers.done(1, 1) == Got{{1, {2}}});
    CHECK(workers.done(1, 2) == Got{{1, {4}}});
    CHECK(balanced(workers.group()));
}

TEST_CASE("group: a live source keeps the newest for the next free member")
{
    Workers workers(1);
    workers.offer(1, false);
    workers.offer(2, false);
    workers.offer(3, false);
    CHECK(workers.done(1, 1) == Got{{1, {3}}});
    CHECK(workers.last_turn == 2);  // turns have no gap where events were skipped
    CHECK(workers.group().skipped == 1);
    CHECK(balanced(workers.group()));
}

TEST_CASE("group: the work of a member that is gone goes to another as the next attempt")
{
    Workers workers(2);
    workers.offer(1);
    workers.offer(2);
    workers.done(2, 1);
    CHECK(workers.got(workers.table.remove(1, false, workers.now)) == Got{{2, {1}}});
    CHECK(workers.last_attempt == 2);
    CHECK(workers.last_turn == 1);
}

TEST_CASE("group: without leases the work of a member that is gone is lost")
{
    Workers workers(2, sharing(), {.leases = false});
    workers.offer(1);
    workers.offer(2);
    workers.done(2, 1);
    CHECK(workers.got(workers.table.remove(1, false, workers.now)).empty());
    CHECK(workers.group().abandoned == 1);
}

TEST_CASE("group: what was taken back goes out before newer events, in its order")
{
    Workers workers(2, sharing(2));
    for (int i = 1; i <= 4; ++i)
        workers.offer(i);  // 1, 3 to the first; 2, 4 to the second
    workers.offer(5);
    CHECK(workers.got(workers.table.remove(1, false, workers.now)).empty());
    CHECK(workers.done(2, 1, 2) == Got{{2, {1}}});
    CHECK(workers.done(2, 2, 2) == Got{{2, {3}}});
    CHECK(workers.done(2, 3, 2) == Got{{2, {5}}});
}

TEST_CASE("group: a lease that expires gives the event to another, and its late answer counts for nothing")
{
    auto options = sharing();
    options.lease = 500ms;
    Workers workers(2, options);
    workers.offer(1);
    CHECK(workers.pass(499ms).empty());
    CHECK(workers.pass(2ms) == Got{{2, {1}}});
    CHECK(workers.offer(2).empty());  // the first member is not trusted with more until it answers
    CHECK(workers.done(1, 1) == Got{{1, {2}}});
    CHECK(workers.group().delivered == 0);
    workers.done(2, 1);
    CHECK(workers.group().delivered == 1);
    CHECK(balanced(workers.group()));
}

TEST_CASE("group: after three attempts an event is given up and said so")
{
    auto options = sharing();
    options.lease = 500ms;
    Workers workers(4, options);
    workers.offer(1);
    workers.pass(501ms);
    workers.pass(501ms);
    CHECK(workers.last_attempt == 3);
    CHECK(workers.failed.empty());
    workers.pass(501ms);
    CHECK(workers.failed == Sequences{1});
    CHECK(workers.last_failed.group == "workers");  // so that an ordered collector does not wait for its turn
    CHECK(workers.last_failed.turn == 1);
    CHECK(workers.last_failed.attempt == 3);
    CHECK(workers.group().abandoned == 1);
    CHECK(balanced(workers.group()));
}

TEST_CASE("group: the lease of queued work begins when it becomes the member's next")
{
    auto options = sharing(2);
    options.lease = 500ms;
    Workers workers(1, options);
    workers.offer(1);
    workers.offer(2);
    workers.pass(400ms);
    workers.done(1, 1, 2);
    CHECK(workers.pass(400ms).empty());
    CHECK(workers.group().in_flight == 1);
    workers.pass(101ms);
    CHECK(workers.table.backlogged());
}

TEST_CASE("group: the lease follows from how long the work has taken")
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

TEST_CASE("group: members join and leave while it runs, and leases of others stay where they are")
{
    Workers workers(1);
    workers.offer(1);
    CHECK(workers.offer(2).empty());
    CHECK(workers.got(workers.table.add(2, "face-2", epoch, sharing(), workers.now)) == Got{{2, {2}}});
    workers.table.remove(2, true, workers.now);
    CHECK(workers.done(1, 1) == Got{{1, {2}}});
}

TEST_CASE("group: work of a source on demand waits for a crashed last member to come back")
{
    Workers workers(1);
    workers.offer(1);
    workers.table.remove(1, false, workers.now);
    CHECK(workers.table.wanted());
    CHECK_FALSE(workers.table.asked());
    CHECK(workers.got(workers.table.add(7, "face-1", epoch, sharing(), workers.now)) == Got{{7, {1}}});
}

TEST_CASE("group: work of a live source waits for a crashed last member too, without holding up or costing the source "
          "anything")
{
    Workers workers(1);
    workers.offer(1, false);
    workers.done(1, 1);
    workers.offer(2, false);
    workers.offer(3, false);
    workers.table.remove(1, false, workers.now);
    CHECK_FALSE(workers.table.wanted());
    CHECK_FALSE(workers.table.backlogged());
    CHECK(workers.group().in_flight == 1);
    CHECK(workers.offer(4, false).empty());
    CHECK(workers.group().produced == 3);
    CHECK(workers.got(workers.table.add(7, "face-1", epoch, sharing(), workers.now)) == Got{{7, {2}}});
    CHECK(workers.last_attempt == 2);
    CHECK(workers.done(7, 1).empty());
    CHECK(workers.group().skipped == 1);  // event 3
    CHECK(balanced(workers.group()));
}

TEST_CASE("group: turns go on after the group was without members, so that results can still be put in order")
{
    for (const bool left : {true, false}) {
        Workers workers(1);
        workers.offer(1, false);
        workers.done(1, 1);
        workers.offer(2, false);
        workers.done(1, 2);
        workers.table.remove(1, left, workers.now);
        workers.table.add(7, "face-1", epoch, sharing(), workers.now);
        CHECK(workers.offer(3, false) == Got{{7, {3}}});
        CHECK(workers.last_turn == 3);
    }
}

TEST_CASE("group: a live source that somebody else receives keeps nothing new for a group without members")
{
    Workers workers(1);
    workers.table.add(9, "view", epoch, window(64), workers.now);
    workers.table.remove(1, false, workers.now);
    CHECK(workers.offer(1, false) == Got{{9, {1}}});
    CHECK(workers.table.asked());
    CHECK(workers.got(workers.table.add(7, "face-1", epoch, sharing(), workers.now)).empty());
}

TEST_CASE("group: the last member that leaves on purpose ends the work: what is left of it is given up and said so")
{
    Workers workers(1, sharing(2));
    workers.offer(1);
    workers.offer(2);
    workers.offer(3);
    workers.got(workers.table.remove(1, true, workers.now));
    CHECK_FALSE(workers.table.wanted());
    CHECK_FALSE(workers.table.backlogged());
    CHECK(workers.failed == Sequences{1, 2, 3});
    CHECK(workers.failed_turns == Sequences{1, 2, 0});
    CHECK(workers.last_failed.group == "");
    CHECK(workers.got(workers.table.add(2, "face-2", epoch, sharing(), workers.now)).empty());
    CHECK(workers.group().abandoned == 3);
    CHECK(balanced(workers.group()));
}

TEST_CASE(
    "group: of the groups without members only the last are remembered, and what waited in a forgotten one is given up")
{
    Workers workers(0);
    const auto member_of = [&](std::size_t number) {
        auto options = sharing();
        options.group = "group-" + std::to_string(number);
        return options;
    };
    for (std::size_t i = 0; i <= ReceiverTable::most_empty_groups; ++i) {
        workers.table.add(i, "face", epoch, member_of(i), workers.now);
        workers.offer(static_cast<std::int64_t>(i), false);
        CHECK(workers.failed.empty());
        workers.got(workers.table.remove(i, false, workers.now));
    }
    CHECK(workers.failed == Sequences{0});
    CHECK(workers.table.rows().size() == ReceiverTable::most_empty_groups);
    CHECK(workers.got(workers.table.add(100, "face", epoch, member_of(0), workers.now)).empty());
    CHECK(workers.got(workers.table.add(101, "face", epoch, member_of(1), workers.now)) == Got{{101, {1}}});
}

}  // namespace hive::event
