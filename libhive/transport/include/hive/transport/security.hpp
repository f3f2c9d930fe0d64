// What a listener and a dialer need to know about keys, and what they tell of those who have none.
#pragma once

#include <hive/role.hpp>
#include <hive/transport/key_ring.hpp>

#include <functional>
#include <memory>
#include <string>

namespace hive::transport {

/// What the end that dialed may do at the end that listens, and by which key.
struct Credentials {
    Role role = Role::viewer;
    std::string key = {};  ///< its id; empty: none was needed
};

/// For tcp alone; at a unix socket the peer's user is looked at instead.
struct Security {
    std::shared_ptr<KeyRing> keys = {};  ///< null: tcp is plain, and whoever comes is a member
    /// A listener turned somebody away before there was a connection: who and why, in one sentence. Network side.
    std::function<void(const std::string&)> refused = [](const std::string&) {};
};

}  // namespace hive::transport
