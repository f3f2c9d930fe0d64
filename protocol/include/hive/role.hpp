// What whoever is connected to a module is to it (libhive/docs/security.md).
#pragma once

#include <string_view>

namespace hive {

/// In the order of what they may do.
enum class Role {
    viewer,  ///< has the viewers' key: looks and receives
    member,  ///< has the swarm's key, or came to a listener that asks for none
    owner    ///< the same user on the same machine
};
std::string_view token(Role role) noexcept;  // "viewer", "member", "owner"

}  // namespace hive
