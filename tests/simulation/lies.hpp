// A process that lies: in one packet that it sends, one field of the header is wrong.
#pragma once

#include "world.hpp"

#include <functional>
#include <string>

namespace hive::simulation {

/// From now on, of the packets that the process sends over new connections, the one behind `before` others has a lie.
/// @param told  gets the changed header
void let_lie(Process& process, int before, std::function<void(const std::string&)> told);

}  // namespace hive::simulation
