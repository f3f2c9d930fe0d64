// From a connected socket to a stream under TLS whose peer has proved the swarm's key, or to the sentence why not.
#pragma once

#include "tls_stream.hpp"

#include <hive/result.hpp>

#include <chrono>
#include <functional>
#include <memory>
#include <string>

namespace hive::transport {

struct HandshakeTerms {
    TlsEnd end;
    std::vector<SwarmKey> keys;  ///< a listener: those that are good; a dialer: the one to show
    std::chrono::milliseconds limit;
    std::string peer;
    bool local;
};

/// The stream, or the error: Errc::not_permitted when the keys do not fit, Errc::malformed when the peer speaks
/// something else, Errc::timeout, Errc::connection_lost.
using OnShaken = std::function<void(Result<std::unique_ptr<Stream>>)>;

/// A handshake that is under way; destroying the last copy ends it, and nobody is told.
using Handshake = std::shared_ptr<void>;

/// Begins. A listener makes no TLS session before the first byte has come, and none at all when that is not the one
/// that TLS begins with. The handler is called once, never from inside. On the network side.
Handshake shake_hands(Socket socket, HandshakeTerms terms, OnShaken on_shaken);

}  // namespace hive::transport
