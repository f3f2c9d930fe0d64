// The end of an output: who is told, behind what, and how it is taken back.
#include "one_consumer.hpp"
#include "table_fixtures.hpp"
#include "workers.hpp"

#include <doctest/doctest.h>

namespace hive::event {
namespace {

using Ids = std::vector<ReceiverId>;

/// Who is told of the end by a call that writes its decisions into its argument.
template <class Call>
Ids told(Call call)
{
    return decided(call).ends;
}

Ids end(OneConsumer& one)
{
    return told([&](Decisions& to) { one.subscription.end(one.now, to); });
}

Ids ask(OneConsumer& one, std::int64_t asked)
{
    return told([&](Decisions& to) { one.subscription.request(1, {asked, asked - 1, asked - 1}, {}, one.now, to); });
}

Ids end(Workers& workers)
{
    return told([&](Decisions& to) { workers.subscription.end(workers.now, to); });
}

/// A member has dealt with its first deliveries.
Ids done(Workers& workers, ReceiverId id, std::int64_t count)
{
    return told([&](Decisions& to) {
        workers.subscription.request(id, {count + 1, count, count}, {}, workers.now, to);
    });
}

Ids end(World& world)
{
    return told([&](Decisions& to) { world.table.end(world.now, to); });
}

/// Something may come again.
Ids revoked(World& world)
{
    return decided([&](Decisions& to) { world.table.go_on(to); }).revoked;
}

Ids add(World& world, ReceiverId id, const std::string& name, const ConnectionOptions& options)
{
    Newcomer newcomer{.id = id, .receiver = name, .options = options};
    newcomer.epoch = world.registrations[id] = ++world.last_registration;
    return told([&](Decisions& to) { world.table.add(newcomer, world.now, to); });
}

}  // namespace

TEST_CASE("end: a receiver that has been sent everything is told at once, and once")
{
    OneConsumer one(window(1));
    one.offer(1);
    CHECK(end(one) == Ids{1});
    CHECK(ask(one, 2).empty());
    CHECK(ask(one, 3).empty());
}

TEST_CASE("end: what waits is sent first, live or lossless")
{
    for (const bool lossless : {false, true}) {
        CAPTURE(lossless);
        OneConsumer one(window(1));
        one.offer(1, lossless);
        one.offer(2, lossless);
        CHECK(end(one).empty());
        const auto last = decided([&](Decisions& to) { one.subscription.request(1, {2, 1, 1}, {}, one.now, to); });
        CHECK(sequences(last) == Sequences{2});
        CHECK(last.ends == Ids{1});
    }
}

TEST_CASE("end: an event that comes after all takes it back from who was not told yet")
{
    OneConsumer one(window(1));
    one.offer(1, true);
    one.offer(2, true);
    CHECK(end(one).empty());
    one.offer(3, true);
    CHECK(ask(one, 2).empty());
    CHECK(ask(one, 3).empty());
    CHECK(end(one) == Ids{1});
}

TEST_CASE("end: a receiver whose place is kept is not told; when it is back it gets what it missed first")
{
    OneConsumer one(window(1));
    one.offer(1, true);
    one.offer(2, true);
    REQUIRE(one.lose(Fate::lost_killed));
    CHECK(end(one).empty());
    CHECK(one.resume(std::nullopt) == Sequences{1});
    CHECK(end(one).empty());
    CHECK(ask(one, 2) == Ids{1});
}

TEST_CASE("end: the members of a group are told when the last of them has answered")
{
    Workers two(2);
    two.offer(1);
    two.offer(2);
    CHECK(end(two).empty());
    CHECK(done(two, 1, 1).empty());
    CHECK(done(two, 2, 1) == Ids{1, 2});
    CHECK(done(two, 2, 1).empty());
}

TEST_CASE("end: what a member that died had in hand is answered by another one before the others are told")
{
    Workers two(2);
    two.offer(1);
    two.offer(2);
    end(two);
    CHECK(done(two, 1, 1).empty());
    CHECK(two.lose(2) == Got{{1, {2}}});
    CHECK(done(two, 1, 2) == Ids{1});
}

TEST_CASE("end: a member that joins after the end is told, and the others not again")
{
    Workers one(1);
    one.offer(1);
    end(one);
    CHECK(done(one, 1, 1) == Ids{1});
    CHECK(told([&](Decisions& to) { one.subscription.attach(2, sharing(), {}, nullptr, one.now, to); }) == Ids{2});
    one.offer(2);
    CHECK(end(one).empty());
    CHECK(done(one, 1, 2) == Ids{1, 2});
}

TEST_CASE("end: a table tells all, whatever they receive, and says why nothing comes")
{
    World world;
    world.add(1, "face.image", window(1));
    world.add(2, "group-1.image", sharing());
    world.add(3, "watcher", streaming(Delivery::notification));
    CHECK(end(world) == Ids{1, 3, 2});
    CHECK(end(world).empty());
    CHECK(world.table.why() == Reason::source_ended);
    world.offer(1);
    CHECK_FALSE(world.table.ended());
    CHECK(world.table.why() != Reason::source_ended);
}

TEST_CASE("end: who registers after the end gets what was held for it, and then the end")
{
    World world;
    world.offer(1, true, true);
    end(world);
    CHECK(world.table.why() == Reason::held);
    Newcomer newcomer{.id = 1, .receiver = "face.image", .epoch = epoch, .options = window(2)};
    const auto decisions = decided([&](Decisions& to) { world.table.add(newcomer, world.now, to); });
    CHECK(sequences(decisions) == Sequences{1});
    CHECK(decisions.ends == Ids{1});
    CHECK(add(world, 2, "late.image", window(1)) == Ids{2});
    CHECK(add(world, 3, "worker.image", sharing()) == Ids{3});
    CHECK(add(world, 4, "worker-2.image", sharing()) == Ids{4});
}

TEST_CASE("end: who was told of it is told that it no longer holds, once, and of the next one again")
{
    World world;
    world.add(1, "face.image", window(1));
    world.add(2, "group-1.image", sharing());
    world.add(3, "watcher", streaming(Delivery::notification));
    end(world);
    CHECK(world.table.told_end(1));
    CHECK(revoked(world) == Ids{1, 3, 2});
    CHECK_FALSE(world.table.told_end(1));
    CHECK(revoked(world).empty());
    CHECK(end(world) == Ids{1, 3, 2});
}

TEST_CASE("end: an event takes it back from all who were told, also from those that do not get it yet")
{
    World world;
    for (const ReceiverId member : {1, 2})
        world.add(member, "worker-" + std::to_string(member) + ".image", sharing());
    world.add(3, "watcher", streaming(Delivery::notification));
    end(world);
    const auto decisions = decided([&](Decisions& to) { world.table.offer(emission(1), false, world.now, to); });
    CHECK(decisions.revoked == Ids{3, 1, 2});
    CHECK(decisions.sends.size() == 2);
}

TEST_CASE("end: a table that goes on tells nobody who was not told before")
{
    World world;
    world.add(1, "face.image", window(1));
    world.offer(1, true);
    world.offer(2, true);
    CHECK(end(world).empty());
    CHECK(revoked(world).empty());
    CHECK(told([&](Decisions& to) {
              world.table.request(1, world.registrations[1], {2, 1, 1}, {}, world.now, to);
          }).empty());
    CHECK(add(world, 2, "late.image", window(1)).empty());
}

}  // namespace hive::event
