// The internals of an application: its module, and requests to drones with a deadline.
#pragma once

#include "directory.hpp"

#include <hive/application.hpp>
#include <hive/event/module.hpp>
#include <hive/result.hpp>

#include <atomic>
#include <memory>
#include <optional>

namespace hive {

/// The error of a drone, with the drone's name.
Error named(const std::string& drone, const Error& error);
/// An error if the peer at a place is another drone: a port may have been reused.
std::optional<Error> wrong_peer(const Place& place, const event::Link& link);

class Application::Core {
public:
    explicit Core(Application::Options options);

    /// Sends a request to one drone and waits; throws the error that it answers.
    /// @param until  its deadline, if that is not the usual one
    Json ask(const std::string& drone, protocol::PacketType type, const Json& header = Json::object(),
             const Body& body = {}, std::optional<event::Clock::time_point> until = {});
    /// Sends requests to several, in parallel as far as descriptors allow, each with its own header, and waits for all.
    /// @param until  the deadline of the request with this index, if that is not the usual one
    std::vector<Answer> ask_all(const std::vector<std::string>& drones, protocol::PacketType type,
                                const std::vector<Json>& headers,
                                const std::function<event::Clock::time_point(std::size_t)>& until = {});
    std::vector<Answer> ask_all(const std::vector<std::string>& drones, protocol::PacketType type, const Json& header);
    /// Where a drone is reachable. Throws Errc::not_found, with the nearest name, if the name is unknown, and
    /// Errc::invalid_argument if several drones have it.
    Place place(const std::string& drone) const;
    /// The same, but an error is returned in the answer.
    [[nodiscard]] Result<Place> place_or_error(const std::string& drone) const;
    /// The same for several. Many names were not typed by hand, so missing ones are not compared with all known names.
    [[nodiscard]] std::vector<Result<Place>> places_or_errors(const std::vector<std::string>& drones) const;
    /// The error for an unknown name.
    [[nodiscard]] Error not_running(const std::string& drone) const;
    /// Sends the request to the receiver.
    void disconnect(const Endpoint& sender, const Endpoint& receiver);
    /// Asks the sender to stop waiting for a receiver that is gone.
    void forget(const Endpoint& sender, const Endpoint& receiver);
    std::vector<ConnectAnswer> connect(const std::vector<SwarmConnection>& connections);
    /// Saves which drones of other machines have just answered.
    void note_answers(const std::vector<StatusAnswer>& answers);
    /// Is a drone running there, as far as this machine can determine?
    [[nodiscard]] bool answers(const Place& place);
    /// Kills a drone of this machine that does not exit, and discards its state.
    void kill(const std::string& drone) const;
    /// Removes its place from the list once it has exited. At the deadline one of this machine is killed; for another
    /// one the error is Errc::timeout.
    [[nodiscard]] std::optional<Error> wait_until_gone(const Place& place, event::Clock::time_point until);
    /// Has this drone crashed and left its saved state?
    [[nodiscard]] bool remembers(const std::string& drone) const;
    [[nodiscard]] std::vector<std::string> remembered() const;
    /// Adds the output's name if the drone has only one.
    Endpoint with_output(const Endpoint& end);
    [[nodiscard]] event::Clock::time_point deadline() const { return event::Clock::now() + timeout; }
    /// Waits until `done`, called with the turn of the loop, or the deadline. Throws Errc::stopped if the caller has
    /// cancelled.
    void wait(event::Clock::time_point deadline, const std::function<bool()>& done);
    void require_not_cancelled() const;

    /// Set by the deadline at the latest: the module guarantees it.
    using Reply = std::shared_ptr<std::optional<event::Outcome>>;
    Reply send(const Place& place, protocol::PacketType type, const Json& header, const Body& body,
               event::Clock::time_point until);

    std::chrono::milliseconds timeout;
    std::function<std::string(const std::string&)> advice_if_missing;
    std::function<bool()> cancelled;  ///< may be empty
    Directory directory;
    event::Module module;
    std::atomic<std::int64_t> sets = 0;  ///< answered: a set may restart a source that had ended

private:
    struct Wire;
    void connect(std::vector<Wire> wires, std::vector<ConnectAnswer>& made);
    struct Asking;
    void begin(const std::shared_ptr<Asking>& asking);
    bool begin_again(const std::shared_ptr<Asking>& asking, const Error& error);
    event::Outcome wait_for(const Reply& reply);  ///< takes the outcome: once
};

}  // namespace hive
