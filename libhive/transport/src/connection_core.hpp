// The working part of a Connection: its stream, reader, writer and clock together.
#pragma once

#include "borrowing.hpp"
#include "lending.hpp"
#include "liveness.hpp"
#include "packet_reader.hpp"
#include "packet_writer.hpp"

#include <hive/transport/connection.hpp>

#include <hive/platform/timer.hpp>

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace hive::transport {

/// Kept alive by pending operations of the io_context (at least the timer, from start() to the end), not by users of
/// the connection: their last reference may be dropped while a read waits. On the network side.
class ConnectionCore : public std::enable_shared_from_this<ConnectionCore> {
public:
    ConnectionCore(asio::io_context& context, std::unique_ptr<Stream> stream, const Timing& timing,
                   std::shared_ptr<void> admission);

    void start(Connection::Handlers handlers);
    void open(const protocol::Limits& limits);
    Carriage send(protocol::Packet packet, Connection::Written written);
    [[nodiscard]] bool has_room(std::size_t control_bytes) const
    {
        return writer_.control_bytes() + control_bytes <= timing_.control_bytes;
    }
    void ping(std::function<void(bool)> answered);
    void share(std::shared_ptr<Pool> pool) { lending_.emplace(std::move(pool)); }
    [[nodiscard]] bool ended_by_peer() const { return ended_by_peer_; }
    [[nodiscard]] bool seemed_dead() const { return seemed_dead_; }
    [[nodiscard]] bool shares() const { return lending_.has_value() && !ended_; }
    /// Ends it; Written callbacks and then `closed` are posted.
    /// @param by_peer  the peer closed it
    void end(const Error& reason, bool by_peer = false);
    /// No user holds the connection any more: ends it, and calls only the Written callbacks.
    void abandon();

private:
    /// Reading pauses between the first packet and open().
    [[nodiscard]] bool held() const { return hello_came_ && !opened_; }
    [[nodiscard]] Error about_peer(const Error& error) const;
    [[nodiscard]] Error read_failure(std::error_code error) const;
    void read();
    void on_read(std::error_code error, std::size_t bytes);
    std::size_t deliver();
    std::optional<protocol::Packet> next_packet();
    [[nodiscard]] bool wants_body(const protocol::Prefix& prefix) const;
    void take(protocol::Packet&& packet);
    void take_pong();
    /// Handles packets about shared memory. True if the packet was one.
    bool take_shared(protocol::Packet& packet);
    Carriage lend(protocol::Packet& packet);
    std::unique_ptr<Borrowing> make_borrowing();
    void give_back();
    void write();
    void on_written(std::error_code error, std::size_t bytes);
    void look_later();
    void look();

    asio::io_context& context_;
    std::unique_ptr<Stream> stream_;
    const std::string peer_;
    const Timing timing_;
    std::shared_ptr<void> admission_;
    platform::Timer timer_;
    Liveness liveness_;
    PacketReader reader_;
    PacketWriter writer_;
    std::optional<Lending> lending_;
    std::unique_ptr<Borrowing> borrowing_;            ///< from the peer's first segment on
    std::shared_ptr<Connection::Handlers> handlers_;  ///< shared with a running call, which may end the connection
    std::optional<Error> ended_;
    struct Ping {
        Liveness::Clock::time_point sent;
        std::function<void(bool)> answered;
    };
    std::deque<Ping> pings_;  ///< unanswered ones, the oldest first
    std::uint64_t most_body_ = 0;
    bool hello_came_ = false;
    bool opened_ = false;
    bool reading_ = false;
    bool writing_ = false;
    bool ended_by_peer_ = false;
    bool seemed_dead_ = false;
};

}  // namespace hive::transport
