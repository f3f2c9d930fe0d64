// What a transport has to provide: an ordered, reliable stream of bytes in both directions. Framing, lanes, heartbeats
// and limits are built above it once (connection.hpp), so a transport is its stream, its listener and its dialer.
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

/// Every function and every handler runs on the network side. A handler is never called from inside the call that
/// it was given to. At most one read and one write are under way at a time. The buffers outlive the handler.
class Stream {
public:
    using Handler = std::function<void(std::error_code, std::size_t bytes)>;

    virtual ~Stream() = default;
    /// Reads at least one byte. End of stream is asio::error::eof.
    virtual void read_some(asio::mutable_buffer into, Handler handler) = 0;
    /// Writes what is taken at once, and returns how many bytes that is. 0: none now, or the stream has ended;
    /// write_some tells which.
    virtual std::size_t write_now(std::span<const asio::const_buffer>) { return 0; }
    /// Writes at least one byte of a gather list, copying nothing.
    virtual void write_some(std::span<const asio::const_buffer> from, Handler handler) = 0;
    /// Can descriptors travel along? Then both ends are on one machine, and it is worth sharing memory.
    [[nodiscard]] virtual bool passes_descriptors() const noexcept { return false; }
    /// Writes as write_some; the peer gets a descriptor of its own for the same thing, with the first byte. Only where
    /// descriptors pass.
    virtual void write_with(int descriptor, std::span<const asio::const_buffer> from, Handler handler);
    /// The oldest descriptor that came with the bytes read so far and was not taken; none: an empty one.
    virtual Descriptor take_descriptor() { return {}; }
    /// Ends both directions; pending handlers are called with asio::error::operation_aborted. May be called twice.
    virtual void close() noexcept = 0;
    /// Who is there, for logs and errors: "pid 4711", "192.0.2.7:50012".
    [[nodiscard]] virtual std::string peer() const = 0;
    /// Is the peer on this machine, as far as its address tells?
    [[nodiscard]] virtual bool local() const = 0;
    /// What the end that dialed may do at the other.
    [[nodiscard]] virtual Credentials credentials() const = 0;
};

}  // namespace hive::transport
