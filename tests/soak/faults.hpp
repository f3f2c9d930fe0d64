// Draws the faults of a soak: steps that break something and mend it again, with pauses between them.
#pragma once

#include <plan.hpp>
#include <random.hpp>

#include <chrono>
#include <map>

namespace hive::soak {

/// The machine of each drone.
using Places = std::map<std::string, std::string>;

struct Swarm {
    mixtures::Topology topology;
    Places places;
};

/// A source on demand, three workers on two machines that share its events, one drone behind them, and one that takes
/// notifications. The options of the connections are drawn.
Swarm make_swarm(mixtures::Random& random);

/// A step, and the pause before it.
struct TimedStep {
    std::chrono::milliseconds pause{};
    mixtures::Step step;
};

struct Fault {
    std::vector<TimedStep> steps;
    bool from_rest = false;  ///< the swarm must be at rest before the first step
};

/// Everything is well again after the last step. No drone is away for longer than its sender waits for it (30 s).
Fault draw_fault(mixtures::Random& random, const Swarm& swarm);
std::string to_text(const Fault& fault);

}  // namespace hive::soak
