// Feeds the inputs at which a drone failed to a fresh drone of its kind, outside of the swarm.
#pragma once

#include <hive/application.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace hive {

/// Which kept failure, and where it is looked for.
struct FailureQuery {
    std::string drone{};      ///< or a file that failure_file() filled: a path with a slash, or NAME.failure
    std::int64_t number = 0;  ///< 0: the newest
    /// The ssh host of the machine that keeps it. Empty: this one, or else that on which the drone was started over
    /// ssh.
    std::string on{};
    std::chrono::milliseconds limit{42'000};  ///< for ssh
    std::function<bool()> cancelled{};        ///< polled while it waits for ssh; true: Errc::stopped
};

/// The failure with bodies. That of a file has the kind, version and parameters of its drone, if they were known there;
/// a Python file that it names is ignored.
/// @throws Error  not_found: none is kept; malformed, too_large, version_mismatch, io: the file is not one;
/// unreachable,
///                timeout: as Remote::hivectl; stopped: cancelled
KeptFailure find_failure(Application& application, const FailureQuery& query);
/// Does this word name a file, and not a drone?
bool is_failure_file(const std::string& word);
/// The content of a file that is enough to rerun a failure anywhere: with the kind, version and parameters that its
/// drone has, or had before it crashed.
/// @throws Error  too_large: its parameters
std::string failure_file(Application& application, KeptFailure failure);

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
    /// How the fresh drone differs from that of a file: another version, parameters that it refuses or that affect this
    /// machine. Sentences.
    std::vector<std::string> unfit{};
    std::string log{};  ///< the last lines of its log; empty with `under`
};

/// The tokens "passed", "threw", "died" and "hung".
std::string_view token(Rerun::Outcome outcome);

/// Starts a drone of the failed one's kind and with its parameters in a home of its own, connected only to the caller;
/// sends it the inputs in their order, with their identities; and always stops it. For the main thread: the drone is
/// also stopped when the thread that started it exits.
///
/// @param failure  with bodies, as find_failure() gives it
/// @throws Error  not_found: the drone is unknown (pass `kind`), or there is no such program; as start() if the fresh
///                drone does not get ready; type_mismatch, not_found: it has no such input; stopped: cancelled
Rerun rerun(Application& application, const KeptFailure& failure, const RerunOptions& options = {});

/// {"drone", "number", "time_us", "code", "text", "inputs": [{"input", "sender", "type", "size", "source", "epoch",
/// "seq", "header"}]}; "sender" is "camera.image".
Json to_json(const KeptFailure& failure);
/// {"outcome", "code", "text", "emitted", "unfit", "log"}
Json to_json(const Rerun& rerun);

}  // namespace hive
