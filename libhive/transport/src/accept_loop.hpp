// Accepts from a listening socket of any family, within the limits on unknown peers and descriptors.
#pragma once

#include "admissions.hpp"
#include "socket_stream.hpp"

#include <hive/transport/transport.hpp>

#include <asio/posix/stream_descriptor.hpp>
#include <asio/steady_timer.hpp>

namespace hive::transport {

/// On the network side; kept alive by its own waits until stop().
class AcceptLoop : public std::enable_shared_from_this<AcceptLoop> {
public:
    /// Makes a stream of an accepted socket, or nothing when that peer may not come in. May throw.
    using Welcome = std::function<std::unique_ptr<Stream>(Socket)>;

    /// Takes over `descriptor`, which listens and does not block.
    AcceptLoop(asio::io_context& context, int family, int descriptor, Welcome welcome, OnConnection on_connection,
               const Timing& timing);
    void start();
    void stop();

private:
    enum class Outcome { accepted, nobody, exhausted };
    void wait();
    void accept_waiting();
    Outcome accept_one();
    void admit(int descriptor);
    void pause();

    asio::io_context& context_;
    const int family_;
    asio::posix::stream_descriptor listening_;
    asio::steady_timer pause_;
    const Welcome welcome_;
    const OnConnection on_connection_;
    const Timing timing_;
    std::shared_ptr<Admissions> admissions_ = std::make_shared<Admissions>();
    bool busy_ = false;  ///< a wait or a pause is under way, or accepting is
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
