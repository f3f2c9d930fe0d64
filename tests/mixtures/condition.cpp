// Following the steps of a plan.
#include "condition.hpp"

#include <algorithm>

namespace hive::mixtures {

Condition::Condition(const Topology& topology) : edges_(topology.edges())
{
    for (const auto& drone : topology.drones())
        lives_[drone] = Life::up;
    for (const auto& edge : topology.edges())
        connected_.insert({edge.sender, edge.receiver});
}

void Condition::follow(const Step& step)
{
    switch (step.verb) {
    case Verb::fail:
        if (step.second == static_cast<int>(Failure::halts))
            lives_[step.drone] = Life::halted;
        else if (step.second == static_cast<int>(Failure::crashes))
            lives_[step.drone] = Life::killed;
        break;
    case Verb::kill:
    case Verb::set_and_kill: lives_[step.drone] = Life::killed; break;
    case Verb::freeze: lives_[step.drone] = Life::frozen; break;
    case Verb::halt: lives_[step.drone] = Life::halted; break;
    case Verb::start:
    case Verb::thaw:
    case Verb::resume: lives_[step.drone] = Life::up; break;
    case Verb::connect: connected_.insert({step.sender, step.drone}); break;
    case Verb::connect_all:
        for (const auto& edge : edges_)
            if (runs(edge.sender) && runs(edge.receiver))
                connected_.insert({edge.sender, edge.receiver});
        break;
    case Verb::disconnect: connected_.erase({step.sender, step.drone}); break;
    case Verb::stop:
        lives_[step.drone] = Life::stopped;
        std::erase_if(connected_, [&](const auto& edge) { return edge.second == step.drone; });
        break;
    default: break;
    }
}

bool Condition::runs(const std::string& drone) const { return life(drone) == Life::up || life(drone) == Life::halted; }

std::size_t Condition::broken() const
{
    return static_cast<std::size_t>(
        std::ranges::count_if(lives_, [](auto& entry) { return entry.second != Life::up; }));
}

}  // namespace hive::mixtures
