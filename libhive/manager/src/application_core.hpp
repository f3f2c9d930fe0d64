// The machinery of an application: its module, and asking drones with a deadline.
#pragma once

#include <hive/application.hpp>
#include <hive/event/module.hpp>

#include <memory>
#include <optional>

namespace hive {

/// The error of a drone, saying whose it is.
Error named(const std::string& drone, const Error& error);

class Application::Core {
public:
    explicit Core(Application::Options options);

    /// Asks one drone and waits; throws what it answers.
    Json ask(const std::string& drone, protocol::PacketType type, const Json& header = Json::object(),
             const Body& body = {});
    /// Asks several at once, each its own header, and waits for all.
    std::vector<Answer> ask_all(const std::vector<std::string>& drones, protocol::PacketType type,
                                const std::vector<Json>& headers);
    std::vector<Answer> ask_all(const std::vector<std::string>& drones, protocol::PacketType type, const Json& header);
    /// Throws Errc::not_found, with the nearest name, when no drone of this name runs here.
    void require_running(const std::string& drone) const;
    /// That error.
    [[nodiscard]] Error not_running(const std::string& drone) const;
    /// The receiver is gone; its sender is to wait for it no longer.
    void forget(const Endpoint& sender, const Endpoint& receiver);
    [[nodiscard]] std::vector<std::string> running() const;
    /// Has what this drone was told outlived it?
    [[nodiscard]] bool remembers(const std::string& drone) const;
    [[nodiscard]] std::vector<std::string> remembered() const;
    /// With the output's name, when the drone has only one.
    Endpoint with_output(const Endpoint& end);
    [[nodiscard]] event::Clock::time_point deadline() const { return event::Clock::now() + timeout; }

    std::chrono::milliseconds timeout;
    std::function<std::string(const std::string&)> advice_if_missing;
    event::Home home;
    event::Module module;

private:
    using Reply =
        std::shared_ptr<const std::optional<event::Outcome>>;  ///< comes by the deadline: the module sees to it
    Reply send(const std::string& drone, protocol::PacketType type, const Json& header, const Body& body);
    const event::Outcome& wait_for(const Reply& reply);
};

}  // namespace hive
