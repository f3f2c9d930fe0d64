// A drone from its declarations to its end: makes the parts, each for its thread, and wires them together.
#pragma once

#include "emitter.hpp"
#include "last_grace.hpp"
#include "listening.hpp"
#include "reporter.hpp"
#include "status_board.hpp"

#include <memory>
#include <optional>

namespace hive {

/// What the command line of a drone says.
struct DroneSettings {
    std::string name;
    service::ListenWish listen;
    Json parameters = Json::object();       ///< --set
    std::optional<ExceptionPolicy> policy;  ///< empty: as before the crash, or skip
    bool halted = false;                    ///< from the start
    bool describe = false;
    bool remote_operator = false;  ///< members may set what is the operator's
};

/// The user thread, but for what says otherwise.
class DroneCore {
public:
    DroneCore(DroneProgram program, DroneSettings settings);
    ~DroneCore();

    void run();

    // --- for Drone and Output ---
    [[nodiscard]] service::Declaration& declaration() noexcept { return declaration_; }
    [[nodiscard]] service::Emitter& emitter() noexcept { return emitter_; }
    [[nodiscard]] std::optional<Json> given(const std::string& parameter) const;
    [[nodiscard]] bool remembered(const std::string& parameter) const;
    [[nodiscard]] Status status();

    // --- for Drone, from any thread ---
    [[nodiscard]] service::Reporter& reporter() noexcept { return reporter_; }
    [[nodiscard]] bool stopping() const noexcept { return board_.stopping(); }
    void condition(const std::string& text, Reason why);
    void source_events(std::int64_t events) { board_.source_events(events); }
    void wake();
    void stop();

private:
    struct Running;  ///< what there is between run() and the end

    void prepare();
    void take_values(const Json& state);
    void serve();
    void end();

    service::LastGrace last_grace_;
    DroneSettings settings_;
    const protocol::Hello self_;
    service::StatusBoard board_;
    service::Declaration declaration_;
    service::Reporter reporter_;
    event::Mailbox mailbox_;
    service::Emitter emitter_;
    std::unique_ptr<Running> running_;
    std::optional<Status> last_status_;  ///< after the loop
};

}  // namespace hive
