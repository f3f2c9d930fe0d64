// A drone from its declarations to its end: creates its parts, each for one thread, and wires them together.
#pragma once

#include "emitter.hpp"
#include "shutdown_watchdog.hpp"
#include "listening.hpp"
#include "reporter.hpp"
#include "status_board.hpp"
#include "wished_connections.hpp"

#include <chrono>
#include <functional>
#include <memory>
#include <optional>

namespace hive {

/// The command line of a drone, and the settings of a program that is only this drone.
struct DroneSettings {
    std::string name;
    service::ListenWish listen;
    Json parameters = Json::object();            ///< --set
    std::vector<protocol::Connect> connections;  ///< --connect
    std::vector<protocol::Expect> expected;      ///< --expect
    DroneOrder order;                            ///< without on_exception: as before the crash, or skip
    std::string swarm = {};                      ///< the swarm that starts it; empty: as before the crash, or none
    /// Replace the running drone of this name, if ready within this time.
    std::optional<std::chrono::steady_clock::time_point> take_over = {};
    bool describe = false;
    bool signals = true;       ///< SIGINT and SIGTERM stop the drone
    bool ends_process = true;  ///< exit the process if the drone's code does not return after a stop
    Log log;                   ///< any thread; empty: the log of the program
};

/// The user thread, unless noted.
class DroneCore {
public:
    DroneCore(DroneProgram program, DroneSettings settings);
    ~DroneCore();

    /// Runs until the drone is told to stop; for --describe it prints the interface instead.
    void run();
    // --- the same in pieces ---
    void start();
    /// Works for about this long. @return whether the drone continues
    bool work(std::chrono::milliseconds time);
    /// Stops the drone as the request `stop` would.
    void finish();
    [[nodiscard]] const DroneSettings& settings() const noexcept { return settings_; }
    [[nodiscard]] Interface interface() const;

    // --- for Drone and Output ---
    [[nodiscard]] service::Declaration& declaration() noexcept { return declaration_; }
    [[nodiscard]] service::Emitter& emitter() noexcept { return emitter_; }
    [[nodiscard]] std::optional<Json> given(const std::string& parameter) const;
    [[nodiscard]] std::optional<Json> told_before(const std::string& parameter) const;
    [[nodiscard]] bool remembered(const std::string& parameter) const;
    [[nodiscard]] Json left_state(const event::Home& home) const;
    [[nodiscard]] Status status();

    // --- for Drone, from any thread ---
    [[nodiscard]] service::Reporter& reporter() noexcept { return reporter_; }
    [[nodiscard]] bool stopping() const noexcept { return board_.stopping(); }
    void condition(const std::string& text, Reason why, LogLevel level);
    void source_events(std::int64_t events) { board_.source_events(events); }
    void wake();
    void stop();

private:
    struct Running;  ///< the parts that exist between run() and the end

    void prepare();
    Json take_values(const Json& state, bool all);
    void begin_work();
    bool take_over();
    void serve();
    void end();
    bool hand_over(std::chrono::seconds grace);
    void ended();

    service::ShutdownWatchdog watchdog_;
    DroneSettings settings_;
    protocol::Hello self_;  ///< its epoch is final when the module is created
    service::StatusBoard board_;
    service::Declaration declaration_;
    service::Reporter reporter_;
    event::Mailbox mailbox_;
    service::Emitter emitter_;
    std::unique_ptr<Running> running_;
    std::optional<Status> last_status_;  ///< after the loop
};

}  // namespace hive
