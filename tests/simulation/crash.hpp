// Prints the current seed when the process crashes.
#pragma once

#include <cstdint>

namespace hive::simulation {

/// From now on a crash or a terminate prints how to replay this seed.
void say_in_a_crash(std::uint64_t seed);

}  // namespace hive::simulation
