// What a drone is doing, in words for a person at a terminal; scripts get the values of the status.
#pragma once

#include "table.hpp"

#include <hive/status.hpp>

namespace hivectl {

/// The state, but "sending" for an idle source that has emitted an event within the last second.
std::string activity_text(const hive::Status& status);
/// How far a source is in its file: "123 of 300"; empty if it has no end.
std::string source_text(const hive::Status& status);

/// Shows both in the row of a drone: as "state" and "done".
void show_activity(Row& row, const hive::Status& status);

}  // namespace hivectl
