// What one run came to, as the line of JSON that a row's program prints.
#pragma once

#include "board.hpp"
#include "run.hpp"

#include <hive/json.hpp>

namespace hive::bench {

/// @param complete  the roles ended in time, and well
Json outcome_of(const Run& run, const Board& board, bool complete);

}  // namespace hive::bench
