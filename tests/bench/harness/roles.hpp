// The part of a run that one process plays.
#pragma once

#include "board.hpp"
#include "transport.hpp"

namespace hive::bench {

/// Plays any role but the controller's; returns when its part is over.
void play(const Transport& transport, const Run& run, Board& board);

}  // namespace hive::bench
