// The unix socket transport: its listener with its file, its dialer, and the check of the peer's user.
#include "accept_loop.hpp"
#include "dial_attempt.hpp"
#include "schemes.hpp"
#include "socket_file.hpp"

#include <asio/error.hpp>

#include <sys/socket.h>
#include <unistd.h>

namespace hive::transport {
namespace {

/// The stream of a connected socket, when the peer runs as our user. Throws Errc::not_permitted.
std::unique_ptr<Stream> stream_to_own_user(Socket socket)
{
    ucred peer{};
    socklen_t size = sizeof peer;
    if (::getsockopt(socket.native_handle(), SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0)
        throw Error(Errc::io, "cannot get the peer's user: " + os_text(errno));
    if (peer.uid != ::geteuid())
        throw Error(Errc::not_permitted, "the peer runs as user " + std::to_string(peer.uid) + ", this end as user "
                                             + std::to_string(::geteuid()));
    set_option(socket.native_handle(), SOL_SOCKET, SO_SNDBUF, local_socket_buffer);
    return make_descriptor_stream(std::move(socket), "pid " + std::to_string(peer.pid));
}

class UnixListener final : public SocketListener {
public:
    UnixListener(std::shared_ptr<AcceptLoop> loop, const Address& address, SocketFile file)
        : SocketListener(std::move(loop), address), file_(std::move(file))
    {
    }

private:
    SocketFile file_;
};

class UnixDial final : public DialAttempt {
public:
    using DialAttempt::DialAttempt;

private:
    void begin() override
    {
        to_ = socket_address(address_.host);
        connect();
    }
    void cancel() noexcept override
    {
        retry_.cancel();
        std::error_code ignored;
        socket_.close(ignored);
    }
    void connect()
    try {
        socket_ = open_socket(context_, AF_UNIX);
        socket_.async_connect({&to_, sizeof to_},
                              [self = std::static_pointer_cast<UnixDial>(shared_from_this())](std::error_code error) {
                                  if (!self->answered())
                                      self->on_connected(error);
                              });
    } catch (const Error& error) {
        fail(Errc::unreachable, error.what());
    }
    void on_connected(std::error_code error)
    try {
        if (error == asio::error::no_buffer_space)
            connect_later();
        else if (error)
            fail(Errc::unreachable, error.message());
        else
            succeed(stream_to_own_user(std::move(socket_)));
    } catch (const Error& refusal) {
        fail(refusal.code() == Errc::not_permitted ? Errc::not_permitted : Errc::unreachable, refusal.what());
    }
    // The listener's queue is full; a unix socket cannot wait for it, and has to retry.
    void connect_later()
    {
        retry_.expires_after(std::chrono::milliseconds(20));
        retry_.async_wait([self = std::static_pointer_cast<UnixDial>(shared_from_this())](std::error_code error) {
            if (!error && !self->answered())
                self->connect();
        });
    }

    sockaddr_un to_{};
    Socket socket_{context_};
    asio::steady_timer retry_{context_};
};

}  // namespace

std::unique_ptr<Listener> listen_unix(asio::io_context& context, const Address& address, OnConnection on_connection,
                                      const Timing& timing, const Security&)
{
    auto socket = open_socket(context, AF_UNIX);
    auto file = SocketFile::bind_and_listen(socket.native_handle(), address);
    auto loop = std::make_shared<AcceptLoop>(
        context, AF_UNIX, socket.release(),
        [](Socket peer, const AcceptLoop::Welcomed& welcomed) -> Handshake {
            welcomed(stream_to_own_user(std::move(peer)));
            return nullptr;
        },
        std::move(on_connection), timing);
    return std::make_unique<UnixListener>(std::move(loop), address, std::move(file));
}

void dial_unix(asio::io_context& context, const Address& address, Milliseconds deadline, OnDialed on_dialed,
               const Timing& timing, const Security&)
{
    std::make_shared<UnixDial>(context, address, std::move(on_dialed), timing)->start(deadline);
}

}  // namespace hive::transport
