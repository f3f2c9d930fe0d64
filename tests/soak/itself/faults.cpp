// Faults that are drawn can be done one after the other, and each seed draws its own.
#include "../faults.hpp"

#include <condition.hpp>

#include <doctest/doctest.h>

#include <set>

using namespace hive::soak;
using namespace hive::mixtures;

TEST_CASE("soak: after each fault everything is up, connected and reachable, and no drone was away for too long")
{
    std::set<Verb> used;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Random random(seed);
        const auto swarm = make_swarm(random);
        Condition condition(swarm.topology);
        for (int i = 0; i < 50; ++i) {
            const auto fault = draw_fault(random, swarm);
            CAPTURE(to_text(fault));
            std::chrono::milliseconds time{};
            int network = 0;
            for (const auto& timed : fault.steps) {
                const auto& step = timed.step;
                time += timed.pause;
                used.insert(step.verb);
                if (step.verb == Verb::cut || step.verb == Verb::swallow)
                    ++network;
                if (step.verb == Verb::mend || step.verb == Verb::let_through)
                    --network;
                if (step.verb == Verb::kill || step.verb == Verb::freeze || step.verb == Verb::stop)
                    REQUIRE(condition.runs(step.drone));
                if (step.verb == Verb::swallow)
                    REQUIRE(step.drone != step.sender);
                condition.follow(step);
            }
            CHECK(time < std::chrono::seconds(25));
            CHECK(network == 0);
            CHECK(condition.broken() == 0);
            CHECK(condition.wanted().size() == swarm.topology.edges().size());
        }
    }
    for (const auto verb : {Verb::kill, Verb::freeze, Verb::halt, Verb::stop, Verb::disconnect, Verb::change,
                            Verb::replace, Verb::fail, Verb::cut, Verb::swallow, Verb::set_twice, Verb::set_and_kill})
        CHECK_MESSAGE(used.contains(verb), token(verb));
}

TEST_CASE("soak: a seed draws the same faults again")
{
    const auto drawn = [](std::uint64_t seed) {
        Random random(seed);
        const auto swarm = make_swarm(random);
        auto text = to_text(swarm.topology);
        for (int i = 0; i < 20; ++i)
            text += to_text(draw_fault(random, swarm)) + "\n";
        return text;
    };
    CHECK(drawn(7) == drawn(7));
    CHECK(drawn(7) != drawn(8));
}
