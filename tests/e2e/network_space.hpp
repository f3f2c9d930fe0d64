// Entering a network namespace, which a thread may do alone, and what sockets there need.
#pragma once

#include <future>
#include <string>

#include <netinet/in.h>

namespace hive::test {

/// The calling thread stays inside: what it opens from now on belongs there. Throws std::runtime_error.
void enter_network(const std::string& name);

/// Does something inside, on a thread that ends with it, and returns what came of it.
template <class Function>
auto inside_network(const std::string& name, Function function)
{
    return std::async(std::launch::async,
                      [&] {
                          enter_network(name);
                          return function();
                      })
        .get();
}

/// Of a socket in a network.
struct NetworkAddress {
    std::string host;  ///< an IPv4 number
    int port = 0;
};
sockaddr_in socket_address(const NetworkAddress& address);

/// The descriptor, or std::runtime_error with what failed and why.
int require_descriptor(int descriptor, const char* what);

}  // namespace hive::test
