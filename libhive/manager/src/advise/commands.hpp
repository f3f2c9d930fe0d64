// Writes the texts and commands of proposals.
#pragma once

#include "measure.hpp"

namespace hive::advising {

/// Fills in text and command. Queries the drones for the options of a further one. Throws the errors that they answer.
void complete(Application& application, const Measured& measured, Candidate& candidate);

}  // namespace hive::advising
