// The system calls behind Socket.
#include "socket.hpp"

#include <cerrno>
#include <cstring>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdexcept>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <utility>

namespace hive::bench {
namespace {

struct Meeting {
    sockaddr_storage storage{};
    socklen_t size = 0;
    [[nodiscard]] const sockaddr* address() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

Meeting meeting_of(const Run& run)
{
    Meeting meeting;
    if (run.is("unix")) {
        auto& address = reinterpret_cast<sockaddr_un&>(meeting.storage);
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path + 1, run.place.data(), run.place.size());  // the leading zero makes it abstract
        meeting.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + run.place.size());
        return meeting;
    }
    auto& address = reinterpret_cast<sockaddr_in&>(meeting.storage);
    address.sin_family = AF_INET;
    address.sin_port = htons(run.port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    meeting.size = sizeof address;
    return meeting;
}

void tune(int descriptor, const Run& run)
{
    const int on = 1, buffer = 256 * 1024;
    if (!run.is("unix"))
        ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (!run.is("b256"))
        return;
    ::setsockopt(descriptor, SOL_SOCKET, SO_SNDBUF, &buffer, sizeof buffer);
    ::setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
}

int open(const Run& run)
{
    const int descriptor = ::socket(run.is("unix") ? AF_UNIX : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (descriptor < 0)
        throw std::runtime_error("no socket");
    tune(descriptor, run);
    return descriptor;
}

[[noreturn]] void fail(const char* what) { throw std::runtime_error(std::string(what) + ": " + std::strerror(errno)); }

}  // namespace

Socket Socket::listen(const Run& run)
{
    Socket socket(open(run));
    const Meeting meeting = meeting_of(run);
    if (::bind(socket.descriptor_, meeting.address(), meeting.size) != 0 || ::listen(socket.descriptor_, 16) != 0)
        fail("listen");
    return socket;
}

Socket Socket::connect(const Run& run)
{
    const Meeting meeting = meeting_of(run);
    for (const auto end = now_ns() + 5 * second;; sleep_for(2 * millisecond)) {
        Socket socket(open(run));
        if (::connect(socket.descriptor_, meeting.address(), meeting.size) == 0)
            return socket;
        if (now_ns() > end)
            fail("connect");
    }
}

Socket Socket::accept(const Run& run) const
{
    const int descriptor = ::accept4(descriptor_, nullptr, nullptr, SOCK_CLOEXEC);
    if (descriptor < 0)
        fail("accept");
    tune(descriptor, run);
    return Socket(descriptor);
}

Socket::~Socket()
{
    if (descriptor_ >= 0)
        ::close(descriptor_);
}

Socket::Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

void Socket::write(std::span<iovec> parts) const
{
    while (!parts.empty()) {
        const auto written = ::writev(descriptor_, parts.data(), static_cast<int>(parts.size()));
        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0)
            fail("write");
        auto left = static_cast<std::size_t>(written);
        for (; !parts.empty() && left >= parts.front().iov_len; parts = parts.subspan(1))
            left -= parts.front().iov_len;
        if (!parts.empty())
            parts.front() = {static_cast<char*>(parts.front().iov_base) + left, parts.front().iov_len - left};
    }
}

bool Socket::read(std::span<std::byte> into) const
{
    while (!into.empty()) {
        const auto count = ::recv(descriptor_, into.data(), into.size(), 0);
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0)
            return false;
        into = into.subspan(static_cast<std::size_t>(count));
    }
    return true;
}

}  // namespace hive::bench
