// Asking a module at an address: what Application does with drones of this machine, for those that are met over TCP.
#pragma once

#include <hive/json.hpp>
#include <hive/protocol/packet.hpp>

#include <memory>
#include <string>

namespace hive::bench {

/// For one thread. An Application finds drones by name, in the home directory; this one is told where they are.
class Caller {
public:
    Caller();
    ~Caller();

    /// Blocks until the answer is here; throws hive::Error, Errc::timeout after 5 s.
    Json ask(const std::string& address, protocol::PacketType type, const Json& header);

private:
    class Module;
    std::unique_ptr<Module> module_;
};

}  // namespace hive::bench
