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
    std::chrono::milliseconds heartbeat{500};      ///< a ping leaves when nothing else was sent for this long
    std::chrono::milliseconds silence{2000};       ///< a peer that sends nothing for this long is dead
    std::chrono::milliseconds first_packet{2000};  ///< the whole first packet must be here by then
    std::chrono::milliseconds stall{5000};   ///< a packet that has begun must go on at 64 KiB/s, or the peer is cut off
    std::size_t control_bytes = 256 * 1024;  ///< more control packets than this waiting: the peer is cut off
};

/// How the body of a packet travels.
enum class Carriage {
    inside,     ///< in the packet: it is small, or the peer is on another machine
    reference,  ///< in shared memory
    fallback    ///< in the packet, although it could have been shared: the pool had no room, or the peer holds too much
};

/// Lives on the network side; all calls and handlers are there. Two lanes leave it: control packets, and events
/// (event, by reference or not, notification, exception and put carry bodies). Control packets overtake waiting events
/// at every packet boundary. Pings and pongs are answered here and shown to nobody, and so is all that is said about
/// shared memory: above, an event has a body, wherever its bytes lie.
///
/// The first packet must fit protocol::hello_limits and be a hello; when it has been handed over, open() raises the
/// limits. A connection that breaks the protocol is closed with the error that says how.
class Connection : public std::enable_shared_from_this<Connection> {
public:
    struct Handlers {
        std::function<void(protocol::Packet&&)> packet;  ///< a whole packet came
        std::function<void(const hive::Error&)> closed;  ///< once, the last call; also after close()
        /// Asked when the prefix of a packet is here. False: nobody takes its body, which is passed over; a body in
        /// shared memory is given back untouched, and its event is not handed over. What this throws ends the
        /// connection. Without this handler all are wanted.
        std::function<bool(protocol::PacketType, std::uint16_t channel)> wants = {};
    };
    /// Called once: true when the last byte is with the operating system, false when the connection ended before.
    using Written = std::function<void(bool)>;

    static std::shared_ptr<Connection> create(asio::io_context& context, std::unique_ptr<Stream> stream,
                                              Timing timing = {});
    virtual ~Connection() = default;

    /// Begins reading. Handlers are dropped after `closed`, so they may own the connection.
    virtual void start(Handlers handlers) = 0;
    /// The peer has said a valid hello: from now on these limits hold.
    virtual void open(const protocol::Limits& limits) = 0;
    /// Queues a packet; never blocks, never calls back from inside. Bodies are not copied: the packet holds them until
    /// they are written. After the end it is dropped (written is called with false).
    virtual Carriage send(protocol::Packet packet, Written written = {}) = 0;
    /// Is there room for a control packet of this size? One more than fits ends the connection.
    [[nodiscard]] virtual bool has_room(std::size_t control_bytes) const = 0;
    /// Sends a ping. `answered` is called once: true when its pong is here, false when the connection ended before.
    virtual void ping(std::function<void(bool)> answered) = 0;
    /// Can memory be shared with this peer, if it wants to?
    [[nodiscard]] virtual bool can_share() const = 0;
    /// The peer wants to: from now on bodies of events that lie in this pool go by reference. Only where can_share().
    virtual void share(std::shared_ptr<Pool> pool) = 0;
    [[nodiscard]] virtual bool shares() const = 0;
    /// Ends the connection; `closed` follows with this error, from the event loop.
    virtual void close(const hive::Error& reason) = 0;
    /// After the end: was it the peer's doing? Otherwise this end closed it, or cut the peer off.
    [[nodiscard]] virtual bool ended_by_peer() const = 0;
    /// After the end: was this end held up for so long, frozen perhaps, that the peer may have cut it off?
    [[nodiscard]] virtual bool seemed_dead() const = 0;
    [[nodiscard]] virtual std::string peer() const = 0;
    /// Is the peer on this machine: at a unix socket, or at an address of this machine?
    [[nodiscard]] virtual bool local() const = 0;
    /// What the end that dialed may do at the end that listens.
    [[nodiscard]] virtual const Credentials& credentials() const = 0;
};

}  // namespace hive::transport
