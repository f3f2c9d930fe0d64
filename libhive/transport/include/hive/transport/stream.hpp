// The interface of a transport: an ordered, reliable stream of bytes in both directions. Framing, lanes, heartbeats and
// limits are implemented once above it (connection.hpp), so a transport is a stream, a listener and a dialer.
#pragma once

#include <hive/error.hpp>
#include <hive/transport/descriptor.hpp>
#include <hive/transport/security.hpp>

#include <asio/buffer.hpp>
#include <asio/io_context.hpp>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <system_error>

namespace hive::transport {

/// Every function and every handler runs on the network side. A handler is never called before the call that got it
/// returns. At most one read and one write are in progress at a time. The buffers outlive the handler.
class Stream {
public:
    using Handler = std::function<void(std::error_code, std::size_t bytes)>;

    virtual ~Stream() = default;
    /// Reads at least one byte. End of stream is asio::error::eof.
    virtual void read_some(asio::mutable_buffer into, Handler handler) = 0;
    /// Writes as much as is possible without waiting, and returns the number of bytes. 0: none now, or the stream has
    /// ended; write_some tells which.
    virtual std::size_t write_now(std::span<const asio::const_buffer>) { return 0; }
    /// Writes at least one byte of a gather list, copying nothing.
    virtual void write_some(std::span<const asio::const_buffer> from, Handler handler) = 0;
    /// Can descriptors be sent? Then both ends are on one machine and can share memory.
    [[nodiscard]] virtual bool passes_descriptors() const noexcept { return false; }
    /// As write_some; with the first byte the peer gets a duplicate of the descriptor. Only if passes_descriptors().
    virtual void write_with(int descriptor, std::span<const asio::const_buffer> from, Handler handler);
    /// The oldest descriptor that arrived with the bytes read so far and was not taken yet; empty if none.
    virtual Descriptor take_descriptor() { return {}; }
    /// Ends both directions; pending handlers are called with asio::error::operation_aborted. May be called twice.
    virtual void close() noexcept = 0;
    /// The peer, for logs and errors: "pid 4711", "192.0.2.7:50012".
    [[nodiscard]] virtual std::string peer() const = 0;
    /// Is the peer on this machine, judged by its address?
    [[nodiscard]] virtual bool local() const = 0;
    /// What the dialer may do at the listener.
    [[nodiscard]] virtual Credentials credentials() const = 0;
};

}  // namespace hive::transport
