// Who may send what to whom: one table of role, packet type and direction (SPEC.md, section 10.3).
#pragma once

#include <hive/protocol/packet.hpp>
#include <hive/role.hpp>

#include <string>

namespace hive::protocol {

/// A connection has an end that dialed and an end that listens. The role is what the dialer is to the listener; the
/// listener is nothing but that to the dialer: it answers, and sends events on channels that the dialer has opened.
enum class Direction { to_listener, to_dialer };

/// Deny by default: what the table does not name is not permitted, and neither is a number that is no type.
bool permits(Role role, Direction direction, PacketType type) noexcept;

/// Why not, in a sentence: "a viewer may not send set".
std::string refusal(Role role, Direction direction, PacketType type);

/// The table as people read it: a line for each type, a column for each role and direction.
std::string permission_table();

}  // namespace hive::protocol
