// A server that accepts connections at any address of this machine, and never sends anything.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <stdexcept>
#include <string>

namespace hive::test {

class MuteServer {
public:
    /// @param port  0: any free one
    explicit MuteServer(std::uint16_t port = 0) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0))
    {
        const int again = 1;  // connections of an earlier listener do not keep the port
        ::setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &again, sizeof again);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        socklen_t size = sizeof address;
        auto* any = reinterpret_cast<sockaddr*>(&address);
        if (::bind(socket_, any, size) != 0 || ::listen(socket_, 8) != 0 || ::getsockname(socket_, any, &size) != 0)
            throw std::runtime_error("cannot listen");
        port_ = ntohs(address.sin_port);
    }
    ~MuteServer() { ::close(socket_); }
    MuteServer(const MuteServer&) = delete;
    MuteServer& operator=(const MuteServer&) = delete;
    [[nodiscard]] std::string port() const { return std::to_string(port_); }
    [[nodiscard]] std::string url() const { return "http://127.0.0.1:" + port() + "/video"; }

private:
    int socket_;
    int port_ = 0;
};

}  // namespace hive::test
