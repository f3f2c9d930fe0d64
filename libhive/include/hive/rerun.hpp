// Feeds the inputs at which a drone failed to a fresh drone of its kind, outside of the swarm.
#pragma once

#include <hive/application.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace hive {

struct RerunOptions {
    std::string kind{};         ///< KIND or FILE.py; empty: that of the failed drone
    std::string program{};      ///< of another build; empty: that of the kind
    Json set = Json::object();  ///< parameters in addition to those of the failed drone
    /// A command that runs the drone at the caller's terminal: {"gdb", "--args"}; then there is no timeout. Empty:
    /// none, and the drone's output goes to `Rerun::log`.
    std::vector<std::string> under{};
    std::chrono::milliseconds limit{30'000};  ///< for the drone to be ready, and then to finish
    std::function<bool()> cancelled{};        ///< polled while it waits; true: Errc::stopped
};

/// Result of processing the inputs in a fresh drone.
struct Rerun {
    enum class Outcome {
        passed,  ///< it did not fail
        threw,   ///< its code threw
        died,    ///< its process exited
        hung     ///< it had not finished within the limit; it was killed
    };
    Outcome outcome = Outcome::passed;
    std::string code{};        ///< threw: the token of the error
    std::string text{};        ///< of the error; died: "SIGSEGV in Haar::detect (cascade.cpp:41)"
    std::int64_t emitted = 0;  ///< events; unknown (0) when it died
    std::string log{};         ///< the last lines of its log; empty with `under`
};

/// The tokens "passed", "threw", "died" and "hung".
std::string_view token(Rerun::Outcome outcome);

/// Starts a drone of the failed one's kind and with its parameters in a home of its own, connected only to the caller;
/// sends it the inputs in their order, with their identities; and always stops it. For the main thread: the drone is
/// also stopped when the thread that started it exits.
///
/// @param failure  with bodies, as Application::failures() gives it
/// @throws Error  not_found: the drone is unknown (pass `kind`), or there is no such program; as start() if the fresh
///                drone does not get ready; type_mismatch, not_found: it has no such input; stopped: cancelled
Rerun rerun(Application& application, const KeptFailure& failure, const RerunOptions& options = {});

/// {"drone", "number", "time_us", "code", "text", "inputs": [{"input", "sender", "type", "size", "source", "epoch",
/// "seq", "header"}]}; "sender" is "camera.image".
Json to_json(const KeptFailure& failure);
/// {"outcome", "code", "text", "emitted", "log"}
Json to_json(const Rerun& rerun);

}  // namespace hive
