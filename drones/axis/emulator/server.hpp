// The emulated camera on the network: one thread, a coroutine for each connection, and a second port that changes its
// behaviour.
#pragma once

#include "behaviour.hpp"

#include <memory>

namespace axis::emulator {

struct ServerSettings {
    std::string address = "127.0.0.1";  ///< that the camera listens at
    unsigned short port = 0;            ///< 0: any
    unsigned short control_port = 0;    ///< always on 127.0.0.1; 0: any
    Credentials owner{"root", "pass"};
    Behaviour behaviour;
};

class Server {
public:
    /// Listens at once.
    /// @throws std::invalid_argument  when the address is none; std::runtime_error  saying where it cannot listen and
    /// why
    explicit Server(const ServerSettings& settings);
    ~Server();
    [[nodiscard]] unsigned short port() const;
    [[nodiscard]] unsigned short control_port() const;
    /// Serves until SIGTERM or SIGINT.
    void run();

private:
    class World;
    std::unique_ptr<World> world_;
};

}  // namespace axis::emulator
