// Finds a free port of this machine.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <fstream>
#include <stdexcept>

namespace hive::test {

/// The port if it is free, or 0; of 0 any that is free.
inline std::uint16_t port_if_free(int port)
{
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    const bool known = ::bind(socket, any, size) == 0 && ::getsockname(socket, any, &size) == 0;
    ::close(socket);
    return known ? ntohs(address.sin_port) : std::uint16_t{0};
}

/// A new one each time, outside of the kernel's ephemeral ports if there are others.
inline std::uint16_t free_port()
{
    constexpr int first = 20'000, of_each_process = 16;
    static std::atomic<int> asked = 0;
    int of_kernel = 0;
    std::ifstream("/proc/sys/net/ipv4/ip_local_port_range") >> of_kernel;
    const bool some_left = of_kernel >= first + 1000;
    for (int attempt = 0; attempt < 100; ++attempt) {
        const int next = ::getpid() * of_each_process + asked++;
        if (const auto port = port_if_free(some_left ? first + next % (of_kernel - first) : 0); port != 0)
            return port;
    }
    throw std::runtime_error("no port is free");
}

}  // namespace hive::test
