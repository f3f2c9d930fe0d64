// Writes an event as one JSON object.
#pragma once

#include "words/table.hpp"

#include <hive/event.hpp>

namespace hivectl {

/// source, epoch, seq of the capture; sender and output it came from; time_us of the capture; age_ms; size of the body;
/// header.
Row event_row(const hive::Event& event);

}  // namespace hivectl
