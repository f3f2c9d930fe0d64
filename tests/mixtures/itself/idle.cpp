// A group with an event that waits, and a member that could take it.
#include "../idle.hpp"

#include <doctest/doctest.h>

using namespace hive;
using namespace hive::mixtures;
using namespace std::chrono_literals;

namespace {

struct Waiting {
    Idle oracle{50ms};
    Idle::Time now{};
    EdgeStatus group{.receiver = "group group-a", .group = true, .options = {.group = "group-a"}, .waiting = 1};
    EdgeStatus member{.receiver = "a1.image", .connected = true, .registration = 5, .options = {.group = "group-a"}};
    InputStatus input{.input = "image", .from = "source.tick", .connected = true, .registration = 5};
    EdgeStatus result{.receiver = "collector", .connected = true};

    /// How many of the next five looks find a problem.
    std::size_t problems()
    {
        std::size_t count = 0;
        for (int i = 0; i < 5; ++i)
            count += oracle.look(statuses(), now += 20ms).size();
        return count;
    }

private:
    [[nodiscard]] Statuses statuses() const
    {
        const OutputStatus tick{.name = "tick", .type = "a/b", .edges = {group, member}};
        const OutputStatus results{.name = "result", .type = "a/b", .edges = {result}};
        return {
            {source, {.name = source, .kind = "ticker", .outputs = {tick}}},
            {"a1", {.name = "a1", .kind = "sleeper", .state = State::idle, .outputs = {results}, .inputs = {input}}}};
    }
};

}  // namespace

TEST_CASE("idle: an event that waits although a member has nothing to do is a problem after a while")
{
    CHECK(Waiting().problems() == 2);
}

TEST_CASE("idle: a member that has not asked, has something in hand, or owes an answer is none")
{
    Waiting nothing_waits, not_asked, in_hand, owes, registered_again;
    nothing_waits.group.waiting = 0;
    CHECK(nothing_waits.problems() == 0);
    not_asked.member.why = Reason::not_asked;
    CHECK(not_asked.problems() == 0);
    in_hand.input.queued = 1;
    CHECK(in_hand.problems() == 0);
    owes.result.events.came(1);
    CHECK(owes.problems() == 0);
    ++registered_again.input.registration;
    CHECK(registered_again.problems() == 0);
}
