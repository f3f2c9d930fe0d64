// Turns a connected socket into a TLS stream whose peer has proved the swarm's key, or an error that says why not.
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
    std::vector<SwarmKey> keys;  ///< a listener: the accepted ones; a dialer: the one to offer
    std::chrono::milliseconds limit;
    std::string peer;
    bool local;
};

/// The stream, or the error: Errc::not_permitted when the keys do not match, Errc::malformed when the peer uses another
/// protocol, Errc::timeout, Errc::connection_lost.
using OnShaken = std::function<void(Result<std::unique_ptr<Stream>>)>;

/// A handshake in progress; destroying the last copy ends it without calling the handler.
using Handshake = std::shared_ptr<void>;

/// Starts. A listener creates no TLS session before the first byte has arrived, and none at all unless that byte begins
/// TLS. The handler is called once, never before this returns. On the network side.
Handshake shake_hands(Socket socket, HandshakeTerms terms, OnShaken on_shaken);

}  // namespace hive::transport
