// Gives what a drone failed at to a fresh drone of its kind, apart from the swarm.
#pragma once

#include <hive/application.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace hive {

struct RerunOptions {
    std::string kind{};         ///< KIND or FILE.py; empty: what the drone is or was
    std::string program{};      ///< its program, of another build; empty: that of the kind
    Json set = Json::object();  ///< parameters, beside those that the drone was given
    /// What runs the drone at the terminal of the caller: {"gdb", "--args"}. It is waited for without limit. Empty:
    /// nothing, and what the drone writes goes to `Rerun::log`.
    std::vector<std::string> under{};
    std::chrono::milliseconds limit{30'000};  ///< for the drone to be ready, and then for it to finish
    std::function<bool()> cancelled{};        ///< asked while it waits; true: Errc::stopped
};

/// What a fresh drone did with the inputs.
struct Rerun {
    enum class Outcome {
        passed,  ///< it did not fail
        threw,   ///< its code threw
        died,    ///< its process ended
        hung     ///< it had not finished within the limit; it was killed
    };
    Outcome outcome = Outcome::passed;
    std::string code{};        ///< threw: the token of the error
    std::string text{};        ///< what the error says; died: "SIGSEGV in Haar::detect (cascade.cpp:41)"
    std::int64_t emitted = 0;  ///< events; unknown (0) when it died
    std::string log{};         ///< the last lines that it wrote; empty with `under`
};

/// The tokens "passed", "threw", "died" and "hung".
std::string_view token(Rerun::Outcome outcome);

/// Starts a drone of the kind and with the parameters that the failed one has, or had before it crashed, in a home of
/// its own, where it is connected to nothing but the caller; gives it the inputs in their order, with their identities;
/// and ends it, whatever happens. For the main thread: the drone also ends when the thread exits that has started it.
///
/// @param failure  with bodies, as Application::failures() gives it
/// @throws Error  not_found: nothing is known of the drone (say `kind`), or there is no such program; what a start
///                throws when the fresh drone does not get ready; type_mismatch, not_found: it has no such input;
///                stopped: cancelled
Rerun rerun(Application& application, const KeptFailure& failure, const RerunOptions& options = {});

/// {"drone", "number", "time_us", "code", "text", "inputs": [{"input", "sender", "type", "size", "source", "epoch",
/// "seq", "header"}]}; "sender" is "camera.image".
Json to_json(const KeptFailure& failure);
/// {"outcome", "code", "text", "emitted", "log"}
Json to_json(const Rerun& rerun);

}  // namespace hive
