// OpenSSL's part: a TLS 1.3 session in which both ends prove the same swarm key, and nothing but that.
#pragma once

#include <hive/key.hpp>

#include <openssl/ssl.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hive::transport {

enum class TlsEnd { listener, dialer };

/// The keys that one handshake is about. It outlives the session's handshake.
struct KeyTalk {
    std::vector<SwarmKey> keys;             ///< a listener: those that are good; a dialer: the one that it shows
    std::optional<std::size_t> shown = {};  ///< which of them the peer named; proved only when the handshake is over
    std::optional<std::string> unknown_id = {};  ///< the peer named another one than these
};

using SslPtr = std::unique_ptr<SSL, decltype(&::SSL_free)>;

/// A session that reads from a connected socket (whose owner closes it) and appends what is to be sent to `outgoing`.
/// Socket, talk and outgoing outlive it. Throws Errc::failed when OpenSSL cannot.
SslPtr make_tls_session(TlsEnd end, int socket, KeyTalk& talk, std::vector<unsigned char>& outgoing);

/// After a handshake: has the peer proved the key that was shown, and not anything else?
bool proved(const SSL& session, const KeyTalk& talk);

}  // namespace hive::transport
