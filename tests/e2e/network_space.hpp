// Enters a network namespace, per thread, and has helpers for sockets there.
#pragma once

#include <future>
#include <string>

#include <netinet/in.h>

namespace hive::test {

/// The calling thread stays inside: its later sockets belong to the namespace. Throws std::runtime_error.
void enter_network(const std::string& name);

/// The calling thread is inside as long as this lives; then it returns.
class NetworkVisit {
public:
    explicit NetworkVisit(const std::string& name);
    ~NetworkVisit();
    NetworkVisit(const NetworkVisit&) = delete;
    NetworkVisit& operator=(const NetworkVisit&) = delete;

private:
    int home_;
};

/// Runs a function inside, on its own thread, and returns its result.
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
