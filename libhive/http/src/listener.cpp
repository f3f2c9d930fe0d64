// Calls socket, bind and listen.
#include "listener.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <netinet/in.h>
#include <stdexcept>

namespace hive::http {

Descriptor listen_at(const Address& address, const std::string& url)
{
    Descriptor socket(::socket(address.raw()->sa_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const int yes = 1;
    ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (::bind(socket.get(), address.raw(), address.size()) != 0 || ::listen(socket.get(), 16) != 0)
        throw std::runtime_error("cannot listen at " + url + ": " + std::strerror(errno));
    return socket;
}

int port_of(const Descriptor& socket)
{
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
    static_assert(offsetof(sockaddr_in, sin_port) == offsetof(sockaddr_in6, sin6_port));
    return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

}  // namespace hive::http
