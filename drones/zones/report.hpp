// Writes counts and occurrences into headers.
#pragma once

#include "observations.hpp"

namespace zones {

/// The header of `counts`: zones, lines and the tracks of the frame, and its size.
/// @param now  up to when the tracks inside have stayed
hive::Json counts_header(const Counter& counter, const Frame& frame, Moment now);
/// The header of `events`. @param of_file  the times are those in a file, so `media_time_us` is written too
hive::Json event_header(const Occurrence& one, bool of_file);

}  // namespace zones
