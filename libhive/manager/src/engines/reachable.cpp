// Opens a connection and closes it.
#include "reachable.hpp"

#include <hive/platform/descriptor.hpp>

#include <cerrno>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

namespace hive {
namespace {

bool connects(const addrinfo& address)
{
    const platform::Descriptor socket(
        ::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, address.ai_protocol));
    bool made = ::connect(socket.get(), address.ai_addr, address.ai_addrlen) == 0;
    if (!made && errno == EINPROGRESS) {
        pollfd writable{socket.get(), POLLOUT, 0};
        int problem = -1;
        socklen_t size = sizeof problem;
        made = ::poll(&writable, 1, 50) == 1 && ::getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &problem, &size) == 0
               && problem == 0;
    }
    return made;
}

}  // namespace

bool reachable(const std::string& host, int port)
{
    addrinfo wanted{};
    wanted.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    if (::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found) != 0)
        return false;
    const bool made = connects(*found);
    ::freeaddrinfo(found);
    return made;
}

}  // namespace hive
