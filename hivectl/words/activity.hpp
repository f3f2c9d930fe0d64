// Describes the activity of a drone for terminals; scripts get the values of the status.
#pragma once

#include "words/table.hpp"

#include <hive/status.hpp>

namespace hivectl {

/// The state, but "sending" for an idle source that has emitted an event within the last second.
std::string activity_text(const hive::Status& status);
/// The position of a source in its file: "123 of 300"; empty without an end.
std::string source_text(const hive::Status& status);

/// Adds both to the row of a drone, as "state" and "done".
void show_activity(Row& row, const hive::Status& status);

}  // namespace hivectl
