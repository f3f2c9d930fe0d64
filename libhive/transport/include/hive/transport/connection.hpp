// A full-duplex connection to one peer: packets in, packets out, heartbeats, limits. The same for every transport.
#pragma once

#include <hive/protocol/packet.hpp>
#include <hive/transport/pool.hpp>
#include <hive/transport/stream.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace hive::transport {

/// Times and sizes of a connection; tests make them short.
struct Timing {
    std::chrono::milliseconds heartbeat{500};      ///< a ping is sent when nothing else was for this long
    std::chrono::milliseconds silence{2000};       ///< a peer that sends nothing for this long is dead
    std::chrono::milliseconds first_packet{2000};  ///< deadline for the whole first packet
    std::chrono::milliseconds stall{5000};         ///< a begun packet must arrive at 64 KiB/s, or the peer is cut off
    std::size_t control_bytes = 256 * 1024;        ///< the peer is disconnected if more control packets than this wait
};

enum class Carriage {
    inside,     ///< in the packet: the body is small, or the peer is on another machine
    reference,  ///< in shared memory
    fallback    ///< in the packet although sharing was possible: the pool was full, or the peer holds too much
};

/// All calls and handlers run on the network side. A connection has two send queues (lanes): control packets, and
/// events (event, by reference or not, notification, exception and put carry bodies). Control packets overtake waiting
/// events at every packet boundary. Pings, pongs and packets about shared memory are handled here and not passed on:
/// for the caller an event has a body, wherever its bytes are.
///
/// The first packet must fit protocol::hello_limits and be a hello; once it has been passed on, open() raises the
/// limits. A connection that breaks the protocol is closed with an error that says how.
class Connection : public std::enable_shared_from_this<Connection> {
public:
    struct Handlers {
        std::function<void(protocol::Packet&&)> packet;  ///< a whole packet arrived
        std::function<void(const hive::Error&)> closed;  ///< once, the last call; also after close()
        /// Called when the prefix of a packet has arrived. False: the body is not needed and is skipped; a body in
        /// shared memory is released untouched, and its event is not passed on. An exception from this closes the
        /// connection. Without this handler all bodies are wanted.
        std::function<bool(protocol::PacketType, std::uint16_t channel)> wants = {};
    };
    /// Called once: true when the operating system has taken the last byte, false when the connection ended before.
    using Written = std::function<void(bool)>;

    static std::shared_ptr<Connection> create(asio::io_context& context, std::unique_ptr<Stream> stream,
                                              Timing timing = {});
    virtual ~Connection() = default;

    /// Starts reading. Handlers are dropped after `closed`, so they may own the connection.
    virtual void start(Handlers handlers) = 0;
    /// Sets the limits from now on; called after a valid hello of the peer.
    virtual void open(const protocol::Limits& limits) = 0;
    /// Queues a packet; never blocks, never calls back before it returns. Bodies are not copied: the packet holds them
    /// until they are written. After the end of the connection the packet is dropped (written is called with false).
    virtual Carriage send(protocol::Packet packet, Written written = {}) = 0;
    /// Is there space for a control packet of this size? Sending one without space closes the connection.
    [[nodiscard]] virtual bool has_room(std::size_t control_bytes) const = 0;
    /// Sends a ping. `answered` is called once: true when its pong arrives, false when the connection ended before.
    virtual void ping(std::function<void(bool)> answered) = 0;
    /// Can memory be shared with this peer, if it agrees?
    [[nodiscard]] virtual bool can_share() const = 0;
    /// The peer agrees to share memory: from now on bodies of events in this pool are sent by reference. Only if
    /// can_share().
    virtual void share(std::shared_ptr<Pool> pool) = 0;
    [[nodiscard]] virtual bool shares() const = 0;
    /// Ends the connection; `closed` follows with this error, from the event loop.
    virtual void close(const hive::Error& reason) = 0;
    /// After the end: did the peer close it? Otherwise this end closed it or disconnected the peer.
    [[nodiscard]] virtual bool ended_by_peer() const = 0;
    /// After the end: may the peer have disconnected this end, because the peer had heard nothing of this end for long?
    [[nodiscard]] virtual bool seemed_dead() const = 0;
    [[nodiscard]] virtual std::string peer() const = 0;
    /// Is the peer on this machine: connected over a unix socket, or at an address of this machine?
    [[nodiscard]] virtual bool local() const = 0;
    /// What the dialer may do at the listener.
    [[nodiscard]] virtual const Credentials& credentials() const = 0;
};

}  // namespace hive::transport
