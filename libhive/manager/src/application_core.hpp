// The machinery of an application: its module, and asking drones with a deadline.
#pragma once

#include "directory.hpp"

#include <hive/application.hpp>
#include <hive/event/module.hpp>

#include <atomic>
#include <memory>
#include <optional>
#include <variant>

namespace hive {

/// The error of a drone, saying whose it is.
Error named(const std::string& drone, const Error& error);
/// An error when the peer at a place is not the drone that is meant: a port may be another one's by now.
std::optional<Error> met_another(const Place& place, const event::Link& link);

class Application::Core {
public:
    explicit Core(Application::Options options);

    /// Asks one drone and waits; throws what it answers.
    Json ask(const std::string& drone, protocol::PacketType type, const Json& header = Json::object(),
             const Body& body = {});
    /// Asks several, as many at once as descriptors allow, each its own header, and waits for all.
    std::vector<Answer> ask_all(const std::vector<std::string>& drones, protocol::PacketType type,
                                const std::vector<Json>& headers);
    std::vector<Answer> ask_all(const std::vector<std::string>& drones, protocol::PacketType type, const Json& header);
    /// Where a drone is met. Throws Errc::not_found, with the nearest name, when none of this name is known, and
    /// Errc::invalid_argument when several are.
    Place place(const std::string& drone) const;
    /// The same, but what was said is kept as the error of an answer.
    [[nodiscard]] std::variant<Place, Error> place_or_error(const std::string& drone) const;
    /// The same for several. Among many, nobody has mistyped one: what is missing is not compared with all there are.
    [[nodiscard]] std::vector<std::variant<Place, Error>>
    places_or_errors(const std::vector<std::string>& drones) const;
    /// The error when there is none.
    [[nodiscard]] Error not_running(const std::string& drone) const;
    /// Asks the receiver.
    void disconnect(const Endpoint& sender, const Endpoint& receiver);
    /// Asks the sender to stop waiting for a receiver that is gone.
    void forget(const Endpoint& sender, const Endpoint& receiver);
    /// Where the receiver can reach the sender, the nearest first; an empty one: by its name in the receiver's home.
    std::vector<std::string> ways(const std::string& sender, const std::string& receiver);
    /// Writes down which drones of other machines have just answered.
    void note_answers(const std::vector<StatusAnswer>& answers);
    /// Does a drone live there, as far as it can be told from here?
    [[nodiscard]] bool answers(const Place& place);
    /// Ends a drone of this machine that does not do so itself, and forgets what it was told.
    void kill(const std::string& drone) const;
    /// Strikes its place off the list when it is. By then one of this machine is killed; of another one the error is
    /// Errc::timeout.
    [[nodiscard]] std::optional<Error> wait_until_gone(const Place& place, event::Clock::time_point until);
    /// Has what this drone was told outlived it?
    [[nodiscard]] bool remembers(const std::string& drone) const;
    [[nodiscard]] std::vector<std::string> remembered() const;
    /// With the output's name, when the drone has only one.
    Endpoint with_output(const Endpoint& end);
    [[nodiscard]] event::Clock::time_point deadline() const { return event::Clock::now() + timeout; }
    /// Until `done`, which is asked with the turn, or the deadline. Throws Errc::stopped when the caller has cancelled.
    void wait(event::Clock::time_point deadline, const std::function<bool()>& done);
    void require_not_cancelled() const;

    /// Comes by the deadline: the module sees to it.
    using Reply = std::shared_ptr<const std::optional<event::Outcome>>;
    Reply send(const Place& place, protocol::PacketType type, const Json& header, const Body& body,
               event::Clock::time_point until);

    std::chrono::milliseconds timeout;
    std::function<std::string(const std::string&)> advice_if_missing;
    std::function<bool()> cancelled;  ///< may be empty
    Directory directory;
    event::Module module;
    std::atomic<std::int64_t> sets = 0;  ///< that were answered: a source may go on that had ended

private:
    struct Asking;
    void begin(const Asking& asking);
    const event::Outcome& wait_for(const Reply& reply);
};

}  // namespace hive
