// Two sockets, each with a thread.
#include "plain_flow.hpp"

#include <vector>

#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace hive::test {
namespace {

constexpr std::size_t piece = 16 * 1024;

int open_socket() { return require_descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), "plain flow: socket"); }

int listening_at(const NetworkAddress& address)
{
    const int listening = open_socket();
    const auto at = socket_address(address);
    require_descriptor(::bind(listening, reinterpret_cast<const sockaddr*>(&at), sizeof at), "plain flow: bind");
    require_descriptor(::listen(listening, 1), "plain flow: listen");
    return listening;
}

int connected_to(const NetworkAddress& address)
{
    const int connected = open_socket();
    const auto to = socket_address(address);
    require_descriptor(::connect(connected, reinterpret_cast<const sockaddr*>(&to), sizeof to), "plain flow: connect");
    return connected;
}

}  // namespace

PlainFlow::PlainFlow(const std::string& from_network, const std::string& to_network, const NetworkAddress& to)
{
    const int listening = inside_network(to_network, [&] { return listening_at(to); });
    sending_ = inside_network(from_network, [&] { return connected_to(to); });
    receiving_ = require_descriptor(::accept4(listening, nullptr, nullptr, SOCK_CLOEXEC), "plain flow: accept");
    ::close(listening);
    sender_ = std::thread([this] { send(); });
    receiver_ = std::thread([this] { receive(); });
}

PlainFlow::~PlainFlow()
{
    ::shutdown(sending_, SHUT_RDWR);
    ::shutdown(receiving_, SHUT_RDWR);
    sender_.join();
    receiver_.join();
    ::close(sending_);
    ::close(receiving_);
}

int PlainFlow::held_bytes() const
{
    int bytes = 0;
    require_descriptor(::ioctl(sending_, SIOCOUTQ, &bytes), "plain flow: what is held");
    return bytes;
}

void PlainFlow::send()
{
    const std::vector<char> bytes(piece);
    while (::send(sending_, bytes.data(), bytes.size(), MSG_NOSIGNAL) > 0)
        ;
}

void PlainFlow::receive()
{
    std::vector<char> bytes(piece);
    for (ssize_t size = 1; size > 0; received_ += size)
        size = ::recv(receiving_, bytes.data(), bytes.size(), 0);
}

}  // namespace hive::test
