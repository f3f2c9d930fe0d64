// A unix socket as a stream that passes descriptors along with its bytes.
#include "socket_stream.hpp"

#include <asio/error.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <sys/socket.h>
#include <unistd.h>

namespace hive::transport {
namespace {

// A segment brings one descriptor, which is taken as soon as the segment is read. A peer that sends more is
// disconnected, so that all peers of a module together cannot use up its descriptors.
constexpr std::size_t most_descriptors = 2;  // pending at once
constexpr std::size_t most_at_once = 2;

std::error_code system_error(int number) { return {number, std::generic_category()}; }

/// The kernel's buffer format for the descriptors of one message.
union Control {
    cmsghdr header;
    std::array<char, CMSG_SPACE(sizeof(int) * most_at_once)> bytes;
};

class DescriptorStream final : public Stream {
public:
    DescriptorStream(Socket socket, std::string peer) : socket_(std::move(socket)), peer_(std::move(peer)) {}

    void read_some(asio::mutable_buffer into, Handler handler) override
    {
        socket_.async_wait(Socket::wait_read,
                           [this, into, handler = std::move(handler)](std::error_code error) mutable {
                               if (!error)
                                   return receive(into, std::move(handler));
                               handler(error, 0);
                           });
    }
    std::size_t write_now(std::span<const asio::const_buffer> from) override
    {
        return transport::write_now(socket_, from);
    }
    void write_some(std::span<const asio::const_buffer> from, Handler handler) override
    {
        socket_.async_write_some(from, std::move(handler));
    }
    [[nodiscard]] bool passes_descriptors() const noexcept override { return true; }
    void write_with(int descriptor, std::span<const asio::const_buffer> from, Handler handler) override
    {
        socket_.async_wait(Socket::wait_write,
                           [this, descriptor, from, handler = std::move(handler)](std::error_code error) mutable {
                               if (!error)
                                   return send(descriptor, from, std::move(handler));
                               handler(error, 0);
                           });
    }
    Descriptor take_descriptor() override
    {
        if (descriptors_.empty())
            return {};
        auto descriptor = std::move(descriptors_.front());
        descriptors_.pop_front();
        return descriptor;
    }
    void close() noexcept override
    {
        std::error_code ignored;
        socket_.close(ignored);
        descriptors_.clear();
    }
    [[nodiscard]] std::string peer() const override { return peer_; }
    [[nodiscard]] bool local() const override { return true; }
    [[nodiscard]] Credentials credentials() const override { return {.role = Role::owner, .key = {}}; }

private:
    void receive(asio::mutable_buffer into, Handler handler)
    {
        iovec bytes{into.data(), into.size()};
        Control control{};
        msghdr message{};
        message.msg_iov = &bytes;
        message.msg_iovlen = 1;
        message.msg_control = &control;
        message.msg_controllen = sizeof control;
        const auto size = ::recvmsg(socket_.native_handle(), &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
        if (size < 0 && (errno == EAGAIN || errno == EINTR))
            return read_some(into, std::move(handler));
        if (size < 0)
            return handler(system_error(errno), 0);
        const auto came = keep_descriptors(message);
        const bool some_missing = (message.msg_flags & MSG_CTRUNC) != 0;
        if (descriptors_.size() > most_descriptors || (some_missing && came == most_at_once))
            return handler(std::make_error_code(std::errc::protocol_error), 0);
        if (some_missing)
            return handler(asio::error::no_descriptors, 0);
        handler(size == 0 ? std::error_code(asio::error::eof) : std::error_code(), static_cast<std::size_t>(size));
    }
    /// Returns the number of descriptors in this message.
    std::size_t keep_descriptors(msghdr& message)
    {
        const auto before = descriptors_.size();
        for (auto* part = CMSG_FIRSTHDR(&message); part; part = CMSG_NXTHDR(&message, part)) {
            if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_RIGHTS)
                continue;
            for (std::size_t at = CMSG_LEN(0); at + sizeof(int) <= part->cmsg_len; at += sizeof(int)) {
                int number = -1;
                std::memcpy(&number, reinterpret_cast<const char*>(part) + at, sizeof number);
                descriptors_.emplace_back(number);
            }
        }
        return descriptors_.size() - before;
    }
    void send(int descriptor, std::span<const asio::const_buffer> from, Handler handler)
    {
        std::array<iovec, 8> bytes{};
        const auto count = std::min(from.size(), bytes.size());
        for (std::size_t i = 0; i < count; ++i)
            bytes[i] = {const_cast<void*>(from[i].data()), from[i].size()};
        Control control{};
        control.header = {.cmsg_len = CMSG_LEN(sizeof descriptor), .cmsg_level = SOL_SOCKET, .cmsg_type = SCM_RIGHTS};
        std::memcpy(CMSG_DATA(&control.header), &descriptor, sizeof descriptor);
        msghdr message{};
        message.msg_iov = bytes.data();
        message.msg_iovlen = count;
        message.msg_control = &control;
        message.msg_controllen = CMSG_SPACE(sizeof descriptor);
        const auto size = ::sendmsg(socket_.native_handle(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
        if (size < 0 && (errno == EAGAIN || errno == EINTR))
            return write_with(descriptor, from, std::move(handler));
        handler(size < 0 ? system_error(errno) : std::error_code(), size < 0 ? 0 : static_cast<std::size_t>(size));
    }

    Socket socket_;
    std::string peer_;
    std::deque<Descriptor> descriptors_;
};

}  // namespace

std::unique_ptr<Stream> make_descriptor_stream(Socket socket, std::string peer)
{
    return std::make_unique<DescriptorStream>(std::move(socket), std::move(peer));
}

}  // namespace hive::transport
