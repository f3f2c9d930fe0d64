// Which seed was played when the process dies.
#pragma once

#include <cstdint>

namespace hive::simulation {

/// From now on a crash or a terminate says how to play this seed again.
void say_in_a_crash(std::uint64_t seed);

}  // namespace hive::simulation
