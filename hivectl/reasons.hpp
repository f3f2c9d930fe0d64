// Why nothing moves, in plain words.
#pragma once

#include <hive/status.hpp>

#include <string>
#include <string_view>

namespace hivectl {

/// "a place is kept for a receiver that was cut off"; empty for Reason::none.
std::string_view sentence(hive::Reason reason) noexcept;

/// Why the drone, its outputs or its inputs stand still: "image: a place is kept for a receiver that was cut off
/// (s1.image)". Empty when all moves. What lasts less than a second is no standstill.
std::string standstill(const hive::Status& status);

}  // namespace hivectl
