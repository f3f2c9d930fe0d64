// Prints how to replay the current round when the process crashes.
#pragma once

#include <string>

namespace hive::simulation {

/// From now on a crash, a terminate, SIGALRM or SIGTERM prints the options that replay this round.
void say_in_a_crash(const std::string& options);

}  // namespace hive::simulation
