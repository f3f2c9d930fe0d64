// Wraps setns() and addresses, with uniform errors.
#include "network_space.hpp"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include <arpa/inet.h>
#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

namespace hive::test {

sockaddr_in socket_address(const NetworkAddress& address)
{
    sockaddr_in result{};
    result.sin_family = AF_INET;
    result.sin_port = htons(static_cast<std::uint16_t>(address.port));
    ::inet_pton(AF_INET, address.host.c_str(), &result.sin_addr);
    return result;
}

int require_descriptor(int descriptor, const char* what)
{
    if (descriptor < 0)
        throw std::runtime_error(std::string(what) + ": " + std::strerror(errno));
    return descriptor;
}

void enter_network(const std::string& name)
{
    const int space = require_descriptor(::open(("/run/netns/" + name).c_str(), O_RDONLY | O_CLOEXEC),
                                         "cannot open a network namespace");
    const int entered = ::setns(space, CLONE_NEWNET);
    ::close(space);
    require_descriptor(entered, "cannot enter a network namespace");
}

NetworkVisit::NetworkVisit(const std::string& name)
    : home_(require_descriptor(::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC),
                               "cannot open the present network namespace"))
{
    enter_network(name);
}

NetworkVisit::~NetworkVisit()
{
    ::setns(home_, CLONE_NEWNET);
    ::close(home_);
}

}  // namespace hive::test
