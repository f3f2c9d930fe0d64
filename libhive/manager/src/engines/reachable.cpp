// Opens a connection and closes it.
#include "reachable.hpp"

#include <cerrno>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace hive {
namespace {

bool connects(const addrinfo& address)
{
    const int socket =
        ::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, address.ai_protocol);
    if (socket < 0)
        return false;
    bool made = ::connect(socket, address.ai_addr, address.ai_addrlen) == 0;
    if (!made && errno == EINPROGRESS) {
        pollfd writable{socket, POLLOUT, 0};
        int problem = -1;
        socklen_t size = sizeof problem;
        made = ::poll(&writable, 1, 50) == 1 && ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &problem, &size) == 0
               && problem == 0;
    }
    ::close(socket);
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
