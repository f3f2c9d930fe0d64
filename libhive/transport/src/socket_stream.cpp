// Reads and writes a socket.
#include "socket_stream.hpp"

#include "unsent_limit.hpp"

#include <algorithm>
#include <array>
#include <sys/socket.h>
#include <unistd.h>

namespace hive::transport {

namespace {

class SocketStream final : public Stream {
public:
    SocketStream(Socket socket, std::string peer, bool local)
        : socket_(std::move(socket)), peer_(std::move(peer)), local_(local)
    {
    }

    // One system call each, with the whole size: asio's composed operations would cut it into slices of 64 KiB.
    void read_some(asio::mutable_buffer into, Handler handler) override
    {
        socket_.async_read_some(into, std::move(handler));
    }
    std::size_t write_now(std::span<const asio::const_buffer> from) override
    {
        return transport::write_now(socket_, from);
    }
    void write_some(std::span<const asio::const_buffer> from, Handler handler) override
    {
        if (!local_)  // write_now() tried it, and the kernel took nothing
            unsent_.fit(socket_.native_handle());
        socket_.async_write_some(from, std::move(handler));
    }
    void close() noexcept override
    {
        std::error_code ignored;
        socket_.close(ignored);
    }
    [[nodiscard]] std::string peer() const override { return peer_; }
    [[nodiscard]] bool local() const override { return local_; }
    [[nodiscard]] Credentials credentials() const override { return {.role = Role::member, .key = {}}; }

private:
    Socket socket_;
    std::string peer_;
    bool local_;
    UnsentLimit unsent_;
};

}  // namespace

std::unique_ptr<Stream> make_socket_stream(Socket socket, std::string peer, bool local)
{
    return std::make_unique<SocketStream>(std::move(socket), std::move(peer), local);
}

std::size_t write_now(Socket& socket, std::span<const asio::const_buffer> from)
{
    std::array<iovec, 64> bytes;
    msghdr message{};
    message.msg_iov = bytes.data();
    message.msg_iovlen = std::min(from.size(), bytes.size());
    for (std::size_t i = 0; i < message.msg_iovlen; ++i)
        bytes[i] = {const_cast<void*>(from[i].data()), from[i].size()};
    const auto size = ::sendmsg(socket.native_handle(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
    return static_cast<std::size_t>(std::max<ssize_t>(size, 0));
}

Socket open_socket(asio::io_context& context, int family)
{
    const int descriptor = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (descriptor < 0)
        throw Error(Errc::io, "cannot open a socket: " + os_text(errno));
    return adopt_socket(context, family, descriptor);
}

Socket adopt_socket(asio::io_context& context, int family, int descriptor)
{
    Socket socket(context);
    std::error_code error;
    socket.assign(asio::generic::stream_protocol(family, 0), descriptor, error);
    if (error) {
        ::close(descriptor);
        throw Error(Errc::io, "cannot watch a socket: " + error.message());
    }
    return socket;
}

void set_option(int descriptor, int level, int option, int value) noexcept
{
    ::setsockopt(descriptor, level, option, &value, sizeof value);
}

}  // namespace hive::transport
