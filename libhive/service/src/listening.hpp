// The addresses of a drone: its local socket, and the ports at which it listens. It keeps its ports after a crash.
#pragma once

#include "reporter.hpp"

#include <hive/discovery/announcer.hpp>
#include <hive/drone_order.hpp>
#include <hive/event/home.hpp>
#include <hive/transport/key_ring.hpp>
#include <hive/transport/listen_address.hpp>

namespace hive::service {

/// The command line's part.
struct ListenWish {
    std::vector<std::string> listen;     ///< besides the local socket: "tcp://HOST:PORT", "tcp://HOST"
    std::vector<std::string> advertise;  ///< addresses for other machines, if they differ
    bool insecure = false;               ///< without a key
    std::string key = {};                ///< the swarm's key file; empty: default_key_file()
    bool no_announce = false;            ///< on the local network
};

/// The command line's settings; without any about listening, those of before the crash.
ListenWish wished(ListenWish told, const Json& state);

/// The swarm's keys; null: none. Throws Errc::not_permitted when the drone should listen on tcp without a members' key.
std::shared_ptr<transport::KeyRing> keys_for(const ListenWish& wish);

using transport::listen_address;

/// The network side.
class Listening {
public:
    Listening(event::Module& module, const event::Home& home, const Reporter& reporter)
        : module_(module), home_(home), reporter_(reporter)
    {
    }

    /// Listens at the local socket and at the given addresses, at the ports of before the crash if they are free.
    /// Throws Errc::name_taken, Errc::not_permitted, Errc::io.
    void begin(const ListenWish& wish, const Json& state);
    /// Withdraws the announcement on the local network. Any thread, after the network side has ended.
    void end() { announcer_.reset(); }
    /// For the state file: the input of begin().
    [[nodiscard]] Json saved() const;
    /// The same as fields of an order, which have one address.
    void tell(DroneOrder& order) const;
    /// Its addresses, the local socket first.
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
