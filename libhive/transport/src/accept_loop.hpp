// Accepts from a listening socket of any family, within the limits on unknown peers and descriptors.
#pragma once

#include "admissions.hpp"
#include "socket_stream.hpp"
#include "tls_handshake.hpp"
#include "waiting_room.hpp"

#include <hive/transport/transport.hpp>

#include <asio/posix/stream_descriptor.hpp>
#include <asio/steady_timer.hpp>

#include <map>

namespace hive::transport {

/// On the network side; kept alive by its own waits until stop().
class AcceptLoop : public std::enable_shared_from_this<AcceptLoop> {
public:
    /// To be called once with the stream of an accepted peer, or nothing; then its slot is free again.
    using Welcomed = std::function<void(std::unique_ptr<Stream>)>;
    /// Checks an accepted socket: answers at once, or later and returns the handshake in progress. May throw.
    using Welcome = std::function<Handshake(Socket, Welcomed)>;

    /// Takes over `descriptor`, a non-blocking listening socket.
    AcceptLoop(asio::io_context& context, int family, int descriptor, Welcome welcome, OnConnection on_connection,
               const Timing& timing);
    void start();
    void stop();

private:
    enum class Outcome { accepted, nobody, exhausted };
    void wait();
    void accept_waiting();
    Outcome accept_one();
    void admit_waiting();
    void admit(WaitingRoom::Peer peer);
    void welcomed(std::uint64_t guest, std::unique_ptr<Stream> stream, std::shared_ptr<void> admission);
    /// Evicts a handshake that takes too long, if any.
    bool make_room();
    [[nodiscard]] bool may_accept() const;
    void pause(std::chrono::milliseconds time);

    asio::io_context& context_;
    const int family_;
    asio::posix::stream_descriptor listening_;
    asio::steady_timer pause_;
    const Welcome welcome_;
    const OnConnection on_connection_;
    const Timing timing_;
    const bool pauses_, by_host_;  ///< false only in twins of tests
    std::shared_ptr<Admissions> admissions_ = std::make_shared<Admissions>();
    WaitingRoom waiting_;
    struct Guest {
        std::string host;
        std::chrono::steady_clock::time_point since;
        Handshake handshake;
    };
    std::map<std::uint64_t, Guest> guests_;  ///< peers in a handshake, in the order of arrival
    std::uint64_t last_guest_ = 0;
    bool busy_ = false;  ///< a wait, a pause or accepting is in progress
};

/// The Listener of sockets: runs a loop while it lives.
class SocketListener : public Listener {
public:
    SocketListener(std::shared_ptr<AcceptLoop> loop, Address address)
        : loop_(std::move(loop)), address_(std::move(address))
    {
        loop_->start();
    }
    SocketListener(const SocketListener&) = delete;
    SocketListener& operator=(const SocketListener&) = delete;
    ~SocketListener() override { loop_->stop(); }
    [[nodiscard]] Address address() const override { return address_; }

private:
    std::shared_ptr<AcceptLoop> loop_;
    Address address_;
};

}  // namespace hive::transport
