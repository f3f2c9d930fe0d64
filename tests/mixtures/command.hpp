// The real command line that receives the results of a whole round, beside the collector.
#pragma once

#include "printed.hpp"

#include <swarm.hpp>

namespace hive::mixtures {

class Command {
public:
    /// Starts `hivectl results`. All drones must run.
    Command(const test::Swarm& swarm, const Topology& topology);

    /// What it printed and how it exited, or that it has not within that time.
    Printed exited(std::chrono::milliseconds timeout);
    /// It should not, before the source has ended.
    std::vector<std::string> fallen();

private:
    const test::Swarm& swarm_;
    test::Process process_;
};

}  // namespace hive::mixtures
