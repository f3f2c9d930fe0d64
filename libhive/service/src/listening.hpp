// Where a drone is met: its local socket, and the ports that it was told to take. It keeps its ports after a crash.
#pragma once

#include "reporter.hpp"

#include <hive/event/home.hpp>

namespace hive::service {

/// What the command line says of it.
struct ListenWish {
    std::vector<std::string> listen;     ///< beside the local socket: "tcp://HOST:PORT", "tcp://HOST"
    std::vector<std::string> advertise;  ///< where others find it, if that is elsewhere
    bool insecure = false;               ///< without a key
};

/// Reads tcp://HOST as well: the port is 0, which means that it is chosen here. Throws Errc::invalid_argument.
transport::Address listen_address(const std::string& text);

/// The network side.
class Listening {
public:
    Listening(event::Module& module, const event::Home& home, const Reporter& reporter)
        : module_(module), home_(home), reporter_(reporter)
    {
    }

    /// Listens at the local socket, and where it is told to; where it is told nothing, at the places of before the
    /// crash. Throws Errc::name_taken, Errc::not_permitted, Errc::io.
    void begin(ListenWish wish, const Json& state);
    /// For the state file: what begin() takes.
    [[nodiscard]] Json saved() const;
    /// Where it is met, the local socket first.
    [[nodiscard]] const std::vector<std::string>& places() const noexcept { return places_; }

private:
    transport::Address listen(const transport::Address& wanted, const std::vector<std::string>& before);

    event::Module& module_;
    const event::Home& home_;
    const Reporter& reporter_;
    ListenWish held_;
    std::vector<std::string> places_;
};

}  // namespace hive::service
