// The role of a connected peer (libhive/docs/security.md).
#pragma once

#include <string_view>

namespace hive {

/// In ascending order of permissions.
enum class Role {
    viewer,  ///< has the viewers' key: may look and receive
    member,  ///< has the swarm's key, or connected to a listener without keys
    owner    ///< the same user on the same machine
};
std::string_view token(Role role) noexcept;  // "viewer", "member", "owner"

}  // namespace hive
