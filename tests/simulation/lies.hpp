// A process that lies: in one packet that it sends, one field of the header is not what it should be.
#pragma once

#include "world.hpp"

#include <functional>
#include <string>

namespace hive::simulation {

/// From now on, of the packets that the process sends over new connections, the one behind `before` others has a lie.
/// @param told  hears what was made of the header
void let_lie(Process& process, int before, std::function<void(const std::string&)> told);

}  // namespace hive::simulation
