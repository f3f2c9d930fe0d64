// The keys of a listener or a dialer, and the report of rejected peers.
#pragma once

#include <hive/role.hpp>
#include <hive/transport/key_ring.hpp>

#include <functional>
#include <memory>
#include <string>

namespace hive::transport {

/// What the dialer may do at the listener, and by which key.
struct Credentials {
    Role role = Role::viewer;
    std::string key = {};  ///< its id; empty: none was needed
};

/// For tcp only; a unix socket checks the peer's user instead.
struct Security {
    std::shared_ptr<KeyRing> keys = {};  ///< null: tcp is unencrypted, and every peer is a member
    /// A listener rejected a peer before there was a connection: the peer and the reason, in one sentence. Network
    /// side.
    std::function<void(const std::string&)> refused = [](const std::string&) {};
};

}  // namespace hive::transport
