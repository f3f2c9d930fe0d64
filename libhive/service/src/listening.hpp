// Where a drone is met: its local socket, and the ports that it was told to take. It keeps its ports after a crash.
#pragma once

#include "reporter.hpp"

#include <hive/discovery/announcer.hpp>
#include <hive/drone_order.hpp>
#include <hive/event/home.hpp>
#include <hive/transport/key_ring.hpp>
#include <hive/transport/listen_address.hpp>

namespace hive::service {

/// What the command line says of it.
struct ListenWish {
    std::vector<std::string> listen;     ///< beside the local socket: "tcp://HOST:PORT", "tcp://HOST"
    std::vector<std::string> advertise;  ///< where others find it, if that is elsewhere
    bool insecure = false;               ///< without a key
    std::string key = {};                ///< the swarm's key file; empty: default_key_file()
    bool no_announce = false;            ///< on the local network
};

/// What is told now; where nothing is told of listening, what held before the crash.
ListenWish wished(ListenWish told, const Json& state);

/// The swarm's keys; null: none. Throws Errc::not_permitted when it is to listen on tcp and there is no members' key.
std::shared_ptr<transport::KeyRing> keys_for(const ListenWish& wish);

using transport::listen_address;

/// The network side.
class Listening {
public:
    Listening(event::Module& module, const event::Home& home, const Reporter& reporter)
        : module_(module), home_(home), reporter_(reporter)
    {
    }

    /// Listens at the local socket, and where it is told to, if it may at the ports of before the crash. Throws
    /// Errc::name_taken, Errc::not_permitted, Errc::io.
    void begin(const ListenWish& wish, const Json& state);
    /// Takes back what is announced on the local network. Any thread, after the network side has ended.
    void end() { announcer_.reset(); }
    /// For the state file: what begin() takes.
    [[nodiscard]] Json saved() const;
    /// The same in the words of an order, which have one address.
    void tell(DroneOrder& order) const;
    /// Where it is met, the local socket first.
    [[nodiscard]] const std::vector<std::string>& places() const noexcept { return places_; }

private:
    void announce();
    transport::Address listen_there(const transport::Address& wanted);
    transport::Address listen(const transport::Address& wanted, const std::vector<std::string>& before);

    event::Module& module_;
    const event::Home& home_;
    const Reporter& reporter_;
    ListenWish held_;
    std::vector<std::string> places_;
    std::unique_ptr<discovery::Announcer> announcer_;
};

}  // namespace hive::service
