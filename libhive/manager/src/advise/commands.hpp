// The commands that make a change, and what it is called.
#pragma once

#include "measure.hpp"

namespace hive::advising {

/// Fills in text and command. Asks the drones for what a further one has to be started with.
/// Throws what they answer.
void complete(Application& application, const Measured& measured, Candidate& candidate);

}  // namespace hive::advising
