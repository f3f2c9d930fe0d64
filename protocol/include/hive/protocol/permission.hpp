// The permissions: one table of role, packet type and direction (SPEC.md, section 10.3).
#pragma once

#include <hive/protocol/packet.hpp>
#include <hive/role.hpp>

#include <string>

namespace hive::protocol {

/// A connection has a dialer and a listener. The role is the dialer's. The listener has none: it answers, and sends
/// events on channels that the dialer has opened.
enum class Direction { to_listener, to_dialer };

/// Denies by default: what the table does not name, and unknown type numbers.
bool permits(Role role, Direction direction, PacketType type) noexcept;

/// The reason for a denial: "a viewer may not send set".
std::string refusal(Role role, Direction direction, PacketType type);

/// The table as readable text: a line per type, a column per role and direction.
std::string permission_table();

}  // namespace hive::protocol
