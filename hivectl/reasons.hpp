// Why nothing moves, in the words of the library.
#pragma once

#include <hive/stall.hpp>

namespace hivectl {

using hive::sentence;

inline std::string standstill(const hive::Status& status) { return hive::stall_text(status); }

}  // namespace hivectl
