// Leaves out halves of the steps, then smaller parts, down to single ones.
#include "shrink.hpp"
#include "condition.hpp"

#include <algorithm>

namespace hive::mixtures {
namespace {

bool can_be_done(const Step& step, const Condition& condition)
{
    const auto is = [&](Life life) { return condition.life(step.drone) == life; };
    const auto both_run = [&] { return condition.runs(step.sender) && condition.runs(step.drone); };
    switch (step.verb) {
    case Verb::feed:
    case Verb::kill:
    case Verb::set_one:
    case Verb::set_and_kill: return condition.runs(step.drone);
    case Verb::start: return is(Life::killed) || is(Life::stopped);
    case Verb::freeze:
    case Verb::halt:
    case Verb::stop: return is(Life::up);
    case Verb::replace:
        return is(Life::up) ? step.sender.empty() || condition.life(step.sender) == Life::up
                            : is(Life::halted) && step.second <= static_cast<int>(Meanwhile::other_kind);
    case Verb::connect_all: return step.drone.empty() || is(Life::up);
    case Verb::fail: return is(Life::up);
    case Verb::thaw: return is(Life::frozen);
    case Verb::resume: return is(Life::halted);
    case Verb::connect: return both_run() && !condition.connected(step.sender, step.drone);
    case Verb::change:
    case Verb::disconnect: return both_run() && condition.connected(step.sender, step.drone);
    case Verb::forget:
        return condition.runs(step.sender) && is(Life::killed) && condition.connected(step.sender, step.drone);
    default: return true;
    }
}

/// Without steps that make no sense any more. @return false when something is left broken at the end
bool make_sound(Plan& plan)
{
    Condition condition(plan.topology);
    std::erase_if(plan.steps, [&](const Step& step) {
        const bool done = can_be_done(step, condition);
        if (done)
            condition.follow(step);
        return !done;
    });
    return condition.broken() == 0 && std::ranges::all_of(plan.topology.edges(), [&](const Edge& edge) {
               return condition.connected(edge.sender, edge.receiver);
           });
}

Plan without(Plan plan, std::size_t from, std::size_t count)
{
    const auto first = plan.steps.begin() + static_cast<std::ptrdiff_t>(from);
    plan.steps.erase(first, first + static_cast<std::ptrdiff_t>(count));
    return plan;
}

}  // namespace

Plan shrunk(Plan plan, const std::function<bool(const Plan&)>& fails)
{
    for (auto part = plan.steps.size() / 2; part > 0; part /= 2)
        for (std::size_t from = 0; from + part < plan.steps.size();) {  // the last step stays: it waits and checks
            auto shorter = without(plan, from, part);
            if (make_sound(shorter) && fails(shorter))
                plan = std::move(shorter);
            else
                from += part;
        }
    return plan;
}

}  // namespace hive::mixtures
