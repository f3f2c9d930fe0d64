// The swarm file of a round, for `hivectl up`.
#pragma once

#include "plan.hpp"

#include <functional>

namespace hive::mixtures {

inline const std::string swarm_name = "round";

struct FileDrone {
    std::string kind;
    std::vector<std::string> settings;  ///< "key=value"
    bool halted = false;
};

std::string swarm_file(const Topology& topology, const std::function<FileDrone(const std::string& drone)>& describe);

}  // namespace hive::mixtures
