// What an application is written against: find drones, describe, connect, configure, collect. hivectl uses only this.
#pragma once

#include <hive/error.hpp>
#include <hive/event.hpp>
#include <hive/interface.hpp>
#include <hive/kept_failure.hpp>
#include <hive/match.hpp>
#include <hive/status.hpp>
#include <hive/transfer.hpp>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hive {

/// Where a drone is met.
struct Place {
    std::string drone;
    std::string host;              ///< `here`, or the machine as it was named when the place was written down
    std::string address;           ///< "unix:/run/user/1000/hive/camera.sock", "tcp://cam1:7700"
    std::string ssh{};             ///< how ssh calls the machine, when the drone was started through it
    std::int64_t answered_us = 0;  ///< on another machine: wall clock of its last answer to this home; 0: none yet
    bool announced = false;        ///< found by what it announces on the local network, and not in the list

    /// The host of the drones of this machine that meet in the home.
    static constexpr const char* here = "local";
    bool operator==(const Place&) const = default;
};

/// The answer of one drone to something asked of several.
struct Answer {
    std::string drone;
    Json result;  ///< an object; meaningful without error
    std::optional<Error> error;
};

/// What one drone of several says of itself.
struct StatusAnswer {
    std::string drone;
    Status status;  ///< meaningful without error
    std::optional<Error> error;
    Place place{};  ///< where it was asked; with an empty address it was not
};

/// A drone of this machine that died of a signal as SIGSEGV, while it does not run.
struct CrashedDrone {
    std::string drone;
    std::int64_t pid = 0;
    std::int64_t time_us = 0;  ///< wall clock
    std::string signal;        ///< "SIGSEGV"
    std::string function;      ///< of its own code where that was, else of libhive; empty: not known
    std::string source;        ///< "/src/face.cpp:12:5"; empty: not known
};

/// A drone that crashes again and again.
struct FailedDrone {
    std::string drone;
    std::string reason;  ///< "crashed 6 times in a row; ..."
    std::string log;     ///< its last lines
};

/// What a set on several drones came to.
struct SetResult {
    enum class Changed {
        all,
        none,    ///< each has its old values
        unclear  ///< some may have the new values and others the old ones: the answers say which, or that it is unknown
    };
    std::vector<Answer> answers;  ///< in the order of the drones; what has changed has no error
    Changed changed = Changed::none;
};

/// One end of a connection: "camera" or "camera.image".
struct Endpoint {
    std::string drone;
    std::string port;  ///< empty: inferred, when only one pair fits
};
std::string to_text(const Endpoint& end);  // "camera.image", "camera"

struct CollectOptions {
    /// A wide window: nothing is skipped unless the collector falls that far behind, and of a source on demand nothing
    /// at all.
    ConnectionOptions connection{.window = 64, .group = {}, .lease = {}};
    bool ordered = false;  ///< results of one source in the order of its captures, however many workers made them
    /// Ordered: how long a missing result holds up those after it. Live events never wait longer than 1 s.
    std::chrono::milliseconds patience{30'000};
};

/// What collecting has counted so far.
struct CollectCounts {
    std::int64_t received = 0;    ///< results handed out
    std::int64_t duplicates = 0;  ///< second answers to shared work, refused
    std::int64_t missing = 0;     ///< turns of shared work whose result never came (ordered)
    std::map<std::string, std::vector<std::int64_t>> missing_turns;  ///< the first of them, by "sender.output#group"
    std::int64_t failed = 0;                                         ///< reported as exceptions instead
    std::int64_t dropped = 0;  ///< lost at this end because they were not taken in time
};

/// Receives events from outputs of drones; connections that end are made again by themselves. Made by
/// Application::collect.
class Collector {
public:
    virtual ~Collector() = default;
    /// The next event, or nothing when `patience` has passed or everything has ended(). User thread.
    virtual std::optional<Event> next(std::chrono::milliseconds patience) = 0;
    /// When all that it receives has come to its end and everything was taken: what is lacking, empty when everything
    /// came. Nothing as long as something may come; so it is again when something comes after all. User thread.
    [[nodiscard]] virtual std::optional<std::string> ended() = 0;
    [[nodiscard]] virtual CollectCounts counts() const = 0;
    /// This end of each connection.
    [[nodiscard]] virtual std::vector<InputStatus> inputs() const = 0;
};

/// Receives sets of events that belong together, one of each output, in the order of the outputs. Made by
/// Application::collect_matched.
class MatchedCollector {
public:
    virtual ~MatchedCollector() = default;
    /// The next set, or nothing when `patience` has passed or everything has ended(); the `input` of each event is its
    /// "drone.output". User thread.
    virtual std::optional<std::vector<Event>> next(std::chrono::milliseconds patience) = 0;
    /// As of a Collector.
    [[nodiscard]] virtual std::optional<std::string> ended() = 0;
    /// `missing` is by "drone.output".
    [[nodiscard]] virtual MatchCounts counts() const = 0;
    /// Of the single events.
    [[nodiscard]] virtual CollectCounts received() const = 0;
    /// This end of each connection.
    [[nodiscard]] virtual std::vector<InputStatus> inputs() const = 0;
};

/// An application in the swarm. Calls block until they are confirmed or their deadline has passed (Errc::timeout); they
/// are for one thread at a time. Everything throws hive::Error.
class Application {
public:
    struct Options {
        std::string name;                         ///< empty: "app-PID", of further ones "app-PID-2"
        std::filesystem::path home;               ///< empty: default_home()
        std::chrono::milliseconds timeout{5000};  ///< of every call
        std::filesystem::path key{};  ///< the swarm's key file, for drones on other machines; empty: default_key_file()
        /// What to advise whoever names a drone that does not run, and no running one is called nearly so.
        std::function<std::string(const std::string& drone)> advice_if_missing{};
        /// Asked again and again while a call waits for drones, on the thread that called: true, and the call throws
        /// Errc::stopped instead of waiting any longer. Whether it has had its effect nobody knows then.
        std::function<bool()> cancelled{};
    };

    Application();
    explicit Application(Options options);
    ~Application();
    Application(const Application&) = delete;
    Application& operator=(const Application&) = delete;

    /// What drones call it: the name of its edges at their outputs.
    [[nodiscard]] const std::string& name() const;
    /// Where the drones of this machine meet.
    [[nodiscard]] const std::filesystem::path& home() const;
    /// Changes the deadline of the calls that follow.
    void timeout(std::chrono::milliseconds timeout);

    // --- find ---
    // A drone is called by its name, wherever it is; by "NAME@HOST" where several have the same name.

    /// The drones that run on this machine, and those of other machines that the list of places names or that announce
    /// themselves on the local network, whether these answer or not; sorted. The first call waits for what the network
    /// knows, for 300 ms at most (a busy daemon: 1 s), where there are a key and an Avahi daemon.
    std::vector<std::string> drones();
    /// Where it is met. Throws Errc::not_found, and Errc::invalid_argument when several have the name.
    Place place(const std::string& drone);
    /// The list of places: drones on other machines that this home was told of, sorted by name.
    std::vector<Place> listed_places();
    /// Writes a place into the list. Throws Errc::invalid_argument when it cannot be one.
    void add_place(const Place& place);
    /// The same for drones that were started just now: an earlier place of one at the same host is out of date and
    /// goes.
    void replace_places(const std::vector<Place>& places);
    /// Strikes a place off the list; false: it was not there.
    bool forget_place(const Place& place);
    /// Names of drones that do not run and get back what they were told when they are started again: they crashed.
    /// Sorted.
    std::vector<std::string> remembered();
    /// Drones that crashed and have left word of it, until they run again or are stopped. Sorted.
    std::vector<CrashedDrone> crashed();
    /// What this drone failed at, by number: the last 4 times, as far as it was kept on this machine, by the drone
    /// itself or by those that sent to it. It need not run.
    /// @param bodies  false: the inputs have their headers and sizes alone
    std::vector<KeptFailure> failures(const std::string& drone, bool bodies = false);
    /// Names of drones that have failures here. Sorted.
    std::vector<std::string> failing();
    /// Drones that crash as soon as whoever stays with their swarm (Swarm::stay) restarts them, until they run again or
    /// are stopped.
    /// Sorted.
    std::vector<FailedDrone> failed();
    /// Expands a glob over the names, or finds one name. Throws Errc::not_found (with the nearest name) when none fits.
    std::vector<std::string> find(const std::string& pattern);
    /// Splits "camera.image" into drone and port; a running drone with the whole name wins.
    Endpoint endpoint(const std::string& text);
    Interface describe(const std::string& drone);
    /// What the drone is doing: state, counters, connections (see SPEC.md, section 6.4).
    Status status(const std::string& drone);
    /// Of many at once; the answers come in the order of the names.
    std::vector<StatusAnswer> status(const std::vector<std::string>& drones);

    // --- wire ---

    /// Connects output to input, confirmed by both. Empty ports are inferred. Returns the ports that were used.
    /// Throws Errc::type_mismatch naming both types, Errc::refused when a drone that keeps state is to share.
    std::pair<Endpoint, Endpoint> connect(const Endpoint& sender, const Endpoint& receiver,
                                          const ConnectionOptions& options = {});
    /// Undoes it. Throws Errc::not_found if there is no such connection. Empty ports: every connection between the two.
    /// A receiver that does not run is forgotten by its sender, which then waits for it no longer.
    void disconnect(const Endpoint& sender, const Endpoint& receiver);

    // --- configure ---

    /// Sets parameters of one drone, all together or none; returns the applied values.
    Json set(const std::string& drone, const Json& parameters);
    /// Sets the same on many: prepared on all, where the drones' own code tries it, then committed on all. If one
    /// refuses, or `cancelled` becomes true before that, none has changed.
    SetResult set(
        const std::vector<std::string>& drones, const Json& parameters,
        const std::function<bool()>& cancelled = [] { return false; });
    /// The present values: of all parameters, or of those named.
    Json get(const std::string& drone, const std::vector<std::string>& names = {});
    std::vector<Answer> get(const std::vector<std::string>& drones, const std::vector<std::string>& names = {});
    /// All values as they were asked for: a drone may have made another value of one, for example by rounding.
    std::vector<Answer> asked(const std::vector<std::string>& drones);

    // --- collect ---

    /// Receives from the outputs; ends when the Collector is destroyed. Returns when every drone has acknowledged.
    std::unique_ptr<Collector> collect(const std::vector<Endpoint>& outputs, const CollectOptions& options = {});
    /// Receives sets of events, one of each of two or more different outputs, that belong together by `match`.
    /// `options.ordered` is not for sets: they come as they are complete.
    std::unique_ptr<MatchedCollector> collect_matched(const std::vector<Endpoint>& outputs,
                                                      Match match = Match::exact(), const CollectOptions& options = {});
    /// Receives the exceptions of drones, as events whose header has "code", "text", "policy".
    std::unique_ptr<Collector> exceptions(const std::vector<std::string>& drones);
    /// Sends one event into an input; returns when the drone has taken it into its queue.
    void put(const Endpoint& input, const Json& header, Body body, const std::string& type);
    /// Sends an event as another drone has sent it, with its identity, but as a live one that is nobody's work.
    void put(const Endpoint& input, const Event& event);

    // --- control ---

    void halt(const std::string& drone);
    void resume(const std::string& drone);
    /// Ends a drone and forgets what it was told, and its place; returns when it is gone. One of this machine that
    /// hangs is killed when the time is over, one that crashed is forgotten only.
    void stop(const std::string& drone);
    /// The same of many at once; returns when all are gone, or their time is over.
    /// @param swarm  not empty: only those that this swarm brought up; others answer Errc::refused
    std::vector<Answer> stop(const std::vector<std::string>& drones, const std::string& swarm = {});
    /// Changes what happens when the drone's code throws.
    void exception_policy(const std::string& drone, ExceptionPolicy policy);

private:
    friend class Inquiry;
    class Core;
    std::unique_ptr<Core> core_;
};

/// Where local drones meet: $HIVE_HOME, or $XDG_RUNTIME_DIR/hive, or /tmp/hive-UID. Only their user can enter it.
std::filesystem::path default_home();

}  // namespace hive
