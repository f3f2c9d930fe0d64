// Derives a separate secret from a key for each use, so that none reveals another.
#pragma once

#include <hive/transport/key.hpp>

#include <string_view>

namespace hive::transport {

/// HKDF-SHA256 of the secret for one use. Throws Errc::failed when OpenSSL cannot.
SwarmKey::Secret derived(const SwarmKey::Secret& secret, std::string_view use);
/// The pre-shared key for TLS.
SwarmKey::Secret tls_secret(const SwarmKey& key);
/// The identity that a dialer sends unencrypted to name its key: "hive-1-member-0123456789abcdef".
std::string tls_identity(const SwarmKey& key);
/// The id of a members' key and of the viewers' key derived from it, computed from the members' secret.
std::string id_of(const SwarmKey::Secret& members);
std::string hex(const unsigned char* bytes, std::size_t size);

}  // namespace hive::transport
