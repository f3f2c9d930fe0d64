// The interface for applications: find drones, describe, connect, configure, collect. hivectl uses only this.
#pragma once

#include <hive/error.hpp>
#include <hive/event.hpp>
#include <hive/interface.hpp>
#include <hive/kept_failure.hpp>
#include <hive/match.hpp>
#include <hive/result.hpp>
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

/// Where a drone is reachable.
struct Place {
    std::string drone;
    std::string host;              ///< `here`, or the machine under the name that was given when the place was saved
    std::string address;           ///< "unix:/run/user/1000/hive/camera.sock", "tcp://cam1:7700"
    std::string ssh{};             ///< the ssh host, if the drone was started over ssh
    std::int64_t answered_us = 0;  ///< on another machine: wall clock of its last answer to this home; 0: none yet
    bool announced = false;        ///< discovered on the local network, and not in the list

    /// The host of drones of this machine in this home.
    static constexpr const char* here = "local";
    bool operator==(const Place&) const = default;
};

/// The answer of one drone to a request to several.
struct Answer {
    std::string drone;
    Result<Json> result;  ///< an object
};

/// The status of one drone of several.
struct StatusAnswer {
    std::string drone;
    Result<Status> status;
    Place place{};  ///< where it was queried; with an empty address it was not
};

/// A drone of this machine that a signal such as SIGSEGV killed and that is not running again.
struct CrashedDrone {
    std::string drone;
    std::int64_t pid = 0;
    std::int64_t time_us = 0;  ///< wall clock
    std::string signal;        ///< "SIGSEGV"
    std::string function;      ///< of its own code if that crashed, else of libhive; empty: not known
    std::string source;        ///< "/src/face.cpp:12:5"; empty: not known
};

/// A drone that crashes repeatedly.
struct FailedDrone {
    std::string drone;
    std::string reason;  ///< "crashed 6 times in a row; ..."
    std::string log;     ///< its last lines
};

/// Result of a set on several drones.
struct SetResult {
    enum class Changed {
        all,
        none,    ///< each has its old values
        unclear  ///< some may have the new values, others the old ones: the answers say which, or that this is unknown
    };
    std::vector<Answer> answers;  ///< in the order of the drones; no error: the drone has the new values
    Changed changed = Changed::none;
};

/// One end of a connection: "camera" or "camera.image".
struct Endpoint {
    std::string drone;
    std::string port;  ///< empty: inferred, when only one pair fits

    bool operator==(const Endpoint&) const = default;
};
std::string to_text(const Endpoint& end);  // "camera.image", "camera"
/// Splits at the last dot: a drone's name may have dots, a port has none. Application::endpoint() knows the drones.
Endpoint parse_endpoint(std::string_view text);

/// A connection between two drones. An empty port is inferred when the connection is made.
struct SwarmConnection {
    Endpoint from, to;
    ConnectionOptions options;

    bool operator==(const SwarmConnection&) const = default;
};

/// The result of one connection of several: the ports that were used, or an error.
struct ConnectAnswer {
    Endpoint sender, receiver;
    std::optional<Error> error;
};

struct CollectOptions {
    /// A wide window: events are skipped only if the collector falls that far behind, and never from a source on
    /// demand.
    ConnectionOptions connection{.window = 64, .group = {}, .lease = {}};
    bool ordered = false;  ///< results of one source in the order of its captures, for any number of workers
    /// Ordered: how long a missing result delays those after it. Live events never wait longer than 1 s.
    std::chrono::milliseconds reorder_timeout{30'000};
};

/// Counters of a collector.
struct CollectCounts {
    std::int64_t received = 0;    ///< results returned
    std::int64_t duplicates = 0;  ///< events and results that came before, discarded
    std::int64_t missing = 0;     ///< turns of shared work whose result never arrived (ordered)
    std::map<std::string, std::vector<std::int64_t>> missing_turns;  ///< the first of them, by "sender.output#group"
    std::int64_t failed = 0;                                         ///< reported as exceptions instead
    std::int64_t dropped = 0;  ///< lost at this end: the caller did not take them in time
};

/// Receives events from outputs of drones; broken connections are restored. Created by Application::collect.
class Collector {
public:
    virtual ~Collector() = default;
    /// The next event, or nothing when `timeout` has passed or everything has ended(). User thread.
    virtual std::optional<Event> next(std::chrono::milliseconds timeout) = 0;
    /// Once all outputs have ended and the caller has taken every event: what is missing, empty if nothing is. Nothing
    /// as long as an event may arrive, and again if one arrives later. User thread.
    [[nodiscard]] virtual std::optional<std::string> ended() = 0;
    [[nodiscard]] virtual CollectCounts counts() const = 0;
    /// This end of each connection.
    [[nodiscard]] virtual std::vector<InputStatus> inputs() const = 0;
};

/// Receives sets of matching events, one of each output, in the order of the outputs. Created by
/// Application::collect_matched.
class MatchedCollector {
public:
    virtual ~MatchedCollector() = default;
    /// The next set, or nothing when `timeout` has passed or everything has ended(); the `input` of each event is its
    /// "drone.output". User thread.
    virtual std::optional<std::vector<Event>> next(std::chrono::milliseconds timeout) = 0;
    /// As Collector::ended.
    [[nodiscard]] virtual std::optional<std::string> ended() = 0;
    /// `missing` is by "drone.output".
    [[nodiscard]] virtual MatchCounts counts() const = 0;
    /// Counters of single events, not of sets.
    [[nodiscard]] virtual CollectCounts received() const = 0;
    /// This end of each connection.
    [[nodiscard]] virtual std::vector<InputStatus> inputs() const = 0;
};

/// An application in the swarm. Calls block until they are confirmed or their deadline has passed (Errc::timeout). For
/// one thread at a time. Every function throws hive::Error.
class Application {
public:
    struct Options {
        std::string name;                         ///< empty: "app-PID", then "app-PID-2" ...
        std::filesystem::path home;               ///< empty: default_home()
        std::chrono::milliseconds timeout{5000};  ///< of every call
        std::filesystem::path key{};  ///< the swarm's key file, for drones on other machines; empty: default_key_file()
        /// Advice for naming a drone that is not running, if no running drone has a similar name.
        std::function<std::string(const std::string& drone)> advice_if_missing{};
        /// Polled on the calling thread while a call waits for drones: if true, the call throws Errc::stopped instead
        /// of waiting longer. Its outcome is then unknown.
        std::function<bool()> cancelled{};
    };

    Application();
    explicit Application(Options options);
    ~Application();
    Application(const Application&) = delete;
    Application& operator=(const Application&) = delete;

    /// The name that drones list for its connections.
    [[nodiscard]] const std::string& name() const;
    /// The home: the runtime directory of the drones of this machine.
    [[nodiscard]] const std::filesystem::path& home() const;
    /// Changes the deadline of the calls that follow.
    void timeout(std::chrono::milliseconds timeout);

    // --- find --- A drone is identified by its name, on any machine; by "NAME@HOST" if several have the same name.

    /// The drones running on this machine, and those of other machines in the list of places or announced on the local
    /// network, answering or not; sorted. With a key and an Avahi daemon, the first call waits at most 300 ms for the
    /// network (1 s if the daemon is busy).
    std::vector<std::string> drones();
    /// Where the drone is reachable. Throws Errc::not_found, or Errc::invalid_argument if several have the name.
    Place place(const std::string& drone);
    /// The list of places: drones on other machines that were saved in this home, sorted by name.
    std::vector<Place> listed_places();
    /// Adds a place to the list. Throws Errc::invalid_argument if it is not a valid place.
    void add_place(const Place& place);
    /// Adds places of drones that were just started, and removes their earlier places at the same host.
    void replace_places(const std::vector<Place>& places);
    /// Removes a place from the list; false: not found.
    bool forget_place(const Place& place);
    /// Names of drones that crashed and will restore their saved state when they are started again. Sorted.
    std::vector<std::string> remembered();
    /// Drones that crashed and left a report, until they run again or are stopped. Sorted.
    std::vector<CrashedDrone> crashed();
    /// The inputs at which this drone failed, by number: the last 4 failures that the drone or its senders kept on this
    /// machine. The drone may have exited.
    /// @param bodies  false: only headers and sizes of the inputs
    std::vector<KeptFailure> failures(const std::string& drone, bool bodies = false);
    /// The kept failure of a crash, without bodies; nothing if its inputs were not kept on this machine.
    std::optional<KeptFailure> failure_of(const CrashedDrone& crash);
    /// Names of drones with failures kept on this machine. Sorted.
    std::vector<std::string> failing();
    /// Drones that crash each time Swarm::stay restarts them, until they run again or are stopped. Sorted.
    std::vector<FailedDrone> failed();
    /// Expands a glob over the names, or finds one name. Throws Errc::not_found (with the nearest name) when none fits.
    std::vector<std::string> find(const std::string& pattern);
    /// Splits "camera.image" into drone and port; a running drone with the whole name wins.
    Endpoint endpoint(const std::string& text);
    Interface describe(const std::string& drone);
    /// What the drone is doing: state, counters, connections (see SPEC.md, section 6.4).
    Status status(const std::string& drone);
    /// Queries all at once; the answers are in the order of the names.
    std::vector<StatusAnswer> status(const std::vector<std::string>& drones);

    // --- wire ---

    /// Connects output to input, confirmed by both. Empty ports are inferred. Returns the ports that were used. Throws
    /// Errc::type_mismatch naming both types, and Errc::refused if a stateful drone is to share.
    std::pair<Endpoint, Endpoint> connect(const Endpoint& sender, const Endpoint& receiver,
                                          const ConnectionOptions& options = {});
    /// Makes all connections at once; the answers are in the same order.
    std::vector<ConnectAnswer> connect(const std::vector<SwarmConnection>& connections);
    /// Removes a connection. Throws Errc::not_found if there is none. Empty ports: every connection between the two. If
    /// the receiver has exited, its sender forgets it and stops waiting for it.
    void disconnect(const Endpoint& sender, const Endpoint& receiver);

    // --- configure ---

    /// Sets parameters of one drone, all together or none; returns the applied values.
    Json set(const std::string& drone, const Json& parameters);
    /// Sets the same values on many drones: all prepare (their own code tries the values), then all commit. If a drone
    /// refuses, or `cancelled` returns true before the commit, no drone is changed.
    SetResult set(
        const std::vector<std::string>& drones, const Json& parameters,
        const std::function<bool()>& cancelled = [] { return false; });
    /// The current values of all parameters, or of those named.
    Json get(const std::string& drone, const std::vector<std::string>& names = {});
    std::vector<Answer> get(const std::vector<std::string>& drones, const std::vector<std::string>& names = {});
    /// All values as requested, before the drone adjusted them, for example by rounding.
    std::vector<Answer> asked(const std::vector<std::string>& drones);

    // --- collect ---

    /// Receives from the outputs; ends when the Collector is destroyed. Returns when every drone has acknowledged.
    std::unique_ptr<Collector> collect(const std::vector<Endpoint>& outputs, const CollectOptions& options = {});
    /// Receives sets of events that match by `match`, one of each of two or more different outputs. `options.ordered`
    /// does not apply: sets arrive as they are completed.
    std::unique_ptr<MatchedCollector> collect_matched(const std::vector<Endpoint>& outputs,
                                                      Match match = Match::exact(), const CollectOptions& options = {});
    /// Receives the exceptions of drones, as events whose header has "code", "text", "policy".
    std::unique_ptr<Collector> exceptions(const std::vector<std::string>& drones);
    /// Sends one event to an input; returns once the drone has queued it.
    void put(const Endpoint& input, const Json& header, Body body, const std::string& type);
    /// Sends an event of another drone with its identity, but as a live event and not as shared work.
    void put(const Endpoint& input, const Event& event);

    // --- control ---

    void halt(const std::string& drone);
    void resume(const std::string& drone);
    /// Stops a drone and discards its state and place; returns when it has exited. On this machine a drone that hangs
    /// is killed at the timeout; of one that crashed, only state and place are discarded.
    void stop(const std::string& drone);
    /// Stops many at once; returns when all have exited, or at the timeout.
    /// @param swarm  not empty: only drones that this swarm brought up; others answer Errc::refused
    std::vector<Answer> stop(const std::vector<std::string>& drones, const std::string& swarm = {});
    /// The same for drones that the caller starts again at once, with all their settings: for 30 s their peers wait for
    /// them, as after a crash, so no lossless event is lost.
    std::vector<Answer> stop_to_restart(const std::vector<std::string>& drones);
    /// Changes what happens when the drone's code throws.
    void exception_policy(const std::string& drone, ExceptionPolicy policy);

private:
    friend class Inquiry;
    class Core;
    std::vector<Answer> stop(const std::vector<std::string>& drones, const std::string& swarm, const Json& header);

    std::unique_ptr<Core> core_;
};

/// The default runtime directory: $HIVE_HOME, or $XDG_RUNTIME_DIR/hive, or /tmp/hive-UID. Only its user has access.
std::filesystem::path default_home();

}  // namespace hive
