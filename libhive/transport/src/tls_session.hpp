// The OpenSSL part: a TLS 1.3 session in which both ends prove the same swarm key.
#pragma once

#include <hive/transport/key.hpp>

#include <openssl/ssl.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hive::transport {

enum class TlsEnd { listener, dialer };

/// The keys of one handshake, which this object outlives.
struct KeyTalk {
    std::vector<SwarmKey> keys;                  ///< a listener: the accepted ones; a dialer: the one it offers
    std::optional<std::size_t> shown = {};       ///< the one that the peer named; proved only after the handshake
    std::optional<std::string> unknown_id = {};  ///< the peer named a key that is not among these
};

using SslPtr = std::unique_ptr<SSL, decltype(&::SSL_free)>;

/// How much a session may read from its socket before other connections are served. OpenSSL itself keeps reading as
/// long as records without data arrive, so this stops a flood of them: a peer that sends more of these than data gets
/// less.
struct SocketTurn {
    static constexpr std::size_t most = 64 * 1024, least = 4 * 1024;
    void begin() { left = std::max(least, most - unpaid); }
    void took(std::size_t bytes)
    {
        left -= bytes;
        taken += bytes;
        unpaid = std::min(unpaid + bytes, most);
    }
    void brought(std::size_t data)
    {
        unpaid -= std::min(unpaid, 2 * data);
        left = std::max(left, most - unpaid);
    }
    /// Far more key updates than any peer needs; each costs about 10 µs.
    [[nodiscard]] bool flooded() const { return key_updates > 16 + taken / (1024 * 1024); }

    int socket = -1;
    std::size_t left = least;   ///< in this turn
    std::size_t unpaid = most;  ///< read bytes that no data has paid for; data pays for twice its size
    std::uint64_t taken = 0;    ///< in all turns
    std::uint64_t key_updates = 0;
    bool ended = false;  ///< the peer has stopped sending
};

/// A session that reads from a connected socket (whose owner closes it) and appends bytes to send to `outgoing`. Turn,
/// talk and outgoing must outlive it. Throws Errc::failed when OpenSSL fails.
SslPtr make_tls_session(TlsEnd end, SocketTurn& turn, KeyTalk& talk, std::vector<unsigned char>& outgoing);

/// After a handshake: has the peer proved the offered key, and nothing else?
bool proved(const SSL& session, const KeyTalk& talk);

}  // namespace hive::transport
