// What is taken from a member that works, and from one that does not.
#include "../lease.hpp"

#include <doctest/doctest.h>

using namespace hive;
using namespace hive::mixtures;
using namespace std::chrono_literals;

namespace {

/// source.tick -> a1.image, shared; looked at every 100 ms.
struct Shared {
    Lease oracle;
    Overdue overdue;
    Lease::Time now{};
    std::int64_t worked = 0, queued = 0, registration = 5, taken = 0;
    State state = State::busy;

    std::size_t look()
    {
        const ConnectionOptions options{.group = "group-a", .lease = 800ms};
        EdgeStatus edge{.receiver = "a1.image", .connected = true, .registration = registration, .options = options};
        edge.events.came(worked + queued + taken);
        edge.events.went(Fate::passed_on, taken);
        const InputStatus input{.input = "image",
                                .from = "source.tick",
                                .connected = true,
                                .registration = registration,
                                .options = options,
                                .received = worked + queued,
                                .processed = worked,
                                .queued = queued};
        const OutputStatus tick{.name = "tick", .type = "a/b", .edges = {edge}};
        const Status source_row{.name = source, .kind = "ticker", .state = State::idle, .outputs = {tick}};
        const Status a1{.name = "a1", .kind = "sleeper", .state = state, .inputs = {input}};
        const Statuses statuses{{source, source_row}, {"a1", a1}};
        now += 100ms;
        return oracle.look(statuses, now).size() + overdue.look(statuses, now).size();
    }
    /// It has had nothing in hand, and goes on for a while.
    void begin()
    {
        queued = 0;
        CHECK(look() == 0);
        for (queued = 2; worked < 10; ++worked)
            CHECK(look() == 0);
        CHECK(look() == 0);
    }
};

}  // namespace

TEST_CASE("lease: what is taken from a member that works is a problem")
{
    Shared shared;
    shared.begin();
    ++shared.taken;
    CHECK(shared.look() == 1);
    CHECK(shared.look() == 0);
    for (int i = 0; i < 4; ++i)
        CHECK(shared.look() == 0);
    ++shared.worked, ++shared.taken;  // it may have hung up to then
    CHECK(shared.look() == 0);
    ++shared.taken;
    CHECK(shared.look() == 1);
}

TEST_CASE("lease: what is taken from a member that hangs, has halted or has registered again is none")
{
    Shared hangs;
    hangs.begin();
    for (int i = 0; i < 6; ++i)
        CHECK(hangs.look() == 0);
    ++hangs.taken;
    CHECK(hangs.look() == 0);

    Shared halts;
    halts.begin();
    halts.state = State::halted;
    ++halts.taken;
    CHECK(halts.look() == 0);

    Shared returns;
    returns.begin();
    ++returns.registration, ++returns.taken;
    CHECK(returns.look() == 0);
    ++returns.worked, ++returns.taken;  // it may be working on what it had
    CHECK(returns.look() == 0);
}

TEST_CASE("lease: what a member does not finish, and the others do not get, is a problem when its lease is over")
{
    Shared hangs;
    hangs.begin();
    for (int i = 0; i < 16; ++i)
        CHECK(hangs.look() == 0);
    CHECK(hangs.look() == 1);

    Shared goes_on;
    goes_on.begin();
    for (int i = 0; i < 40; ++i, goes_on.worked += i % 10 == 0 ? 1 : 0)
        CHECK(goes_on.look() == 0);
}
