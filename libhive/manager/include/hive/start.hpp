// Starts one drone, or replaces a running one, here or on a machine that ssh reaches.
#pragma once

#include <hive/swarm_plan.hpp>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace hive {

struct StartOptions {
    SwarmDrone drone{};                       ///< an empty name: the usual one of its kind; `host` is not used
    std::string ssh{};                        ///< the machine as ssh knows it; empty: this one
    bool if_missing = false;                  ///< one of this name and kind that runs there already counts as started
    std::chrono::milliseconds limit{10'000};  ///< for the drone to be ready
    std::function<bool()> cancelled{};        ///< asked while it waits; true: Errc::stopped
    std::function<void(const std::string& text)> told{};  ///< gets what an operator should know meanwhile
};

struct Started {
    Place place{};
    std::string log{};        ///< on its machine; empty: not known
    bool found = false;       ///< it ran already
    std::int64_t before = 0;  ///< the process that it has replaced
};

/// Starts a drone in the background and returns when it is ready. The drone keeps running when the caller exits;
/// whatever goes wrong, it is stopped again. A listed place of this name that does not answer is forgotten.
///
/// Throws Errc::name_taken when a drone has the name, Errc::not_found when there is no such program, the error of the
/// drone's exit code with the last lines of its log when it exits instead, Errc::timeout, and for other machines what
/// Remote throws.
Started start(Application& application, StartOptions options);

/// Starts a process that takes over from a running drone: it gets ready while the old one works, then name, places,
/// parameters and connections pass over, and the old one exits after the callback that it is in. A drone that has
/// halted stays halted. Returns when the new one answers.
///
/// Until the new one is ready, every error leaves the old one as it was: Errc::not_found (no such drone, no such
/// program), Errc::type_mismatch and Errc::refused (the new one does not have what is connected or set; the old one
/// keeps state and `lose_state` is not set; it runs on another machine and was not started through ssh),
/// Errc::name_taken (it is being replaced already), Errc::timeout. Then it goes on by itself, even when the caller is
/// killed or cancels. If the new one crashes before it has the name, another one is started in its place.
///
/// @param options  `drone` has the name, and what is to be otherwise than for the old one; `ssh` and `if_missing` are
///                 not used; `limit`: for the new one to be ready
Started replace(Application& application, StartOptions options);

/// A drone of this machine that runs for as long as the object lives. It is stopped, however this process exits.
class TiedDrone {
public:
    /// Starts it under the first of NAME, NAME-2, NAME-3 ... that is free. Throws as start() does. For the main thread:
    /// the drone is stopped when the thread exits that has started it.
    TiedDrone(Application& application, const StartOptions& options);
    /// Stops it and removes its log.
    ~TiedDrone();
    TiedDrone(const TiedDrone&) = delete;
    TiedDrone& operator=(const TiedDrone&) = delete;

    [[nodiscard]] const std::string& name() const;
    /// Once it has exited, how, with the last lines of its log; Errc::stopped: with exit code 0.
    [[nodiscard]] std::optional<Error> exited();

private:
    class Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace hive
