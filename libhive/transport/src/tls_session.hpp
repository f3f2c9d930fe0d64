// OpenSSL's part: a TLS 1.3 session in which both ends prove the same swarm key, and nothing but that.
#pragma once

#include <hive/key.hpp>

#include <openssl/ssl.h>

#include <algorithm>
#include <cstdint>
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

/// How much a session may take from its socket before others have their turn. OpenSSL reads on by itself as long as
/// records come that bring no data, so this is what ends a flood of them: who sends more of these than data gets less.
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
    /// Far more changes of the keys than anybody needs; each costs about 10 µs.
    [[nodiscard]] bool flooded() const { return key_updates > 16 + taken / (1024 * 1024); }

    int socket = -1;
    std::size_t left = least;   ///< in this turn
    std::size_t unpaid = most;  ///< of what was taken; data pays for twice its size
    std::uint64_t taken = 0;    ///< in all turns
    std::uint64_t key_updates = 0;
    bool ended = false;  ///< the peer sends no more
};

/// A session that reads from a connected socket (whose owner closes it) and appends what is to be sent to `outgoing`.
/// Turn, talk and outgoing outlive it. Throws Errc::failed when OpenSSL cannot.
SslPtr make_tls_session(TlsEnd end, SocketTurn& turn, KeyTalk& talk, std::vector<unsigned char>& outgoing);

/// After a handshake: has the peer proved the key that was shown, and not anything else?
bool proved(const SSL& session, const KeyTalk& talk);

}  // namespace hive::transport
