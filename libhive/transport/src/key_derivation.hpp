// What is made of a key: each use has a secret of its own, so that none tells anything about another.
#pragma once

#include <hive/key.hpp>

#include <string_view>

namespace hive::transport {

/// HKDF-SHA256 of the secret for one use. Throws Errc::failed when OpenSSL cannot.
SwarmKey::Secret derived(const SwarmKey::Secret& secret, std::string_view use);
/// What TLS is given as its pre-shared key.
SwarmKey::Secret tls_secret(const SwarmKey& key);
/// What a dialer says in the clear to name its key: "hive-1-member-0123456789abcdef".
std::string tls_identity(const SwarmKey& key);
/// The id of a members' key, or of the viewers' key made of it: of the members' secret.
std::string id_of(const SwarmKey::Secret& members);
std::string hex(const unsigned char* bytes, std::size_t size);

}  // namespace hive::transport
