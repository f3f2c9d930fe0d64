// What a round on real drones has beside its plan. A generator of its own draws it, so a seed has the same plan in the
// simulated world.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hive::mixtures {

struct Extras {
    bool ends = false;     ///< the source ends when it has made what it may, and goes on when it is fed
    bool up = false;       ///< `hivectl up` starts and connects the drones, and `hivectl down` ends them
    bool command = false;  ///< `hivectl results` receives the results as well
    std::vector<std::string> bystanders = {};
};

Extras make_extras(std::uint64_t seed);
/// "the source does not end, -> hivectl results"
std::string to_text(const Extras& extras);

}  // namespace hive::mixtures
