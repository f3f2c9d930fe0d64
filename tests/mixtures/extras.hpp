// What a round on real drones has beside its plan. A generator of its own draws it, so a seed has the same plan in the
// simulated world.
#pragma once

#include <cstdint>
#include <string>

namespace hive::mixtures {

struct Extras {
    bool command = false;  ///< `hivectl results` receives the results as well
};

Extras make_extras(std::uint64_t seed);
/// " -> hivectl results"
std::string to_text(const Extras& extras);

}  // namespace hive::mixtures
