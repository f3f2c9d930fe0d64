// A round that fails becomes as short as what it fails of, and can still be played.
#include "../shrink.hpp"
#include "../condition.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace hive::mixtures;

namespace {

/// It would fail because a worker is killed while another one has halted.
bool killed_beside_halted(const Plan& plan)
{
    Condition condition(plan.topology);
    return std::ranges::any_of(plan.steps, [&](const Step& step) {
        condition.follow(step);
        return step.verb == Verb::kill
               && std::ranges::any_of(condition.lives(), [](const auto& each) { return each.second == Life::halted; });
    });
}

}  // namespace

TEST_CASE("mixtures: a round is shrunk to the steps that it fails of and those that mend them")
{
    int tried = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        const auto plan = make_plan(seed, 30);
        if (!killed_beside_halted(plan))
            continue;
        ++tried;
        const auto shorter = shrunk(plan, killed_beside_halted);
        CHECK(killed_beside_halted(shorter));
        CHECK(shorter.steps.size() <= 6);  // halt, kill, start, rest; and resume, or kill and start of the halted one
        CHECK(shorter.steps.back().verb == Verb::rest);
    }
    CHECK(tried > 20);
}

TEST_CASE("mixtures: a round that does not fail in any shorter form stays as it is")
{
    const auto plan = make_plan(1, 10);
    CHECK(shrunk(plan, [](const Plan&) { return false; }).steps.size() == plan.steps.size());
}
