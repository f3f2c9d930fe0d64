// Starts one drone, or replaces a running one, on this machine or over ssh.
#pragma once

#include <hive/swarm_plan.hpp>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace hive {

struct StartOptions {
    SwarmDrone drone{};                       ///< an empty name: the default of its kind; `host` is not used
    std::string ssh{};                        ///< the ssh host; empty: this machine
    bool if_missing = false;                  ///< a running one of this name and kind counts as started
    std::chrono::milliseconds limit{10'000};  ///< for the drone to be ready
    std::function<bool()> cancelled{};        ///< polled while it waits; true: Errc::stopped
    std::function<void(const std::string& text)> told{};  ///< gets messages for the operator
};

struct Started {
    Place place{};
    std::string log{};        ///< on its machine; empty: not known
    bool found = false;       ///< it was already running
    std::int64_t before = 0;  ///< the replaced process
};

/// Starts a drone in the background and returns when it is ready. The drone keeps running when the caller exits; after
/// any error it is stopped. A listed place of this name that does not answer is removed.
///
/// Throws Errc::name_taken if a drone has the name, Errc::not_found if there is no such program, the error of the
/// drone's exit code with the end of its log if it exits, Errc::timeout, and for other machines as Remote.
Started start(Application& application, StartOptions options);

/// Starts a process that takes over from a running drone: it gets ready while the old one works, then gets its name,
/// places, parameters and connections, and the old one exits after its current callback. A halted drone stays halted.
/// Returns when the new one answers.
///
/// Until the new one is ready, every error leaves the old one as it was: Errc::not_found (no such drone, no such
/// program), Errc::type_mismatch and Errc::refused (the new one lacks a connected port or a set parameter; the old one
/// keeps state and `lose_state` is not set; it runs on another machine and was not started over ssh), Errc::name_taken
/// (it is already being replaced), Errc::timeout. After that, the takeover completes even if the caller is killed or
/// cancels. If the new one crashes before it has the name, another one is started in its place.
///
/// With `force`, a drone that does not answer within 3 s, or is of another version of Hive, is killed, and a new one is
/// started with its parameters and connections; its other options get their defaults. Errors leave the old one as it
/// was.
///
/// @param options  `drone` has the name and the changes from the old one; `ssh` and `if_missing` are not used; `limit`:
///                 for the new one to be ready
Started replace(Application& application, StartOptions options);

/// A drone of this machine that runs as long as the object lives. It is stopped however this process exits.
class TiedDrone {
public:
    /// Starts it under the first free name of NAME, NAME-2, NAME-3 ... Throws as start(). For the main thread: the
    /// drone is stopped when the thread that started it exits.
    TiedDrone(Application& application, const StartOptions& options);
    /// Stops it and removes its log.
    ~TiedDrone();
    TiedDrone(const TiedDrone&) = delete;
    TiedDrone& operator=(const TiedDrone&) = delete;

    [[nodiscard]] const std::string& name() const;
    /// How it exited, with the end of its log; Errc::stopped: with exit code 0. Nothing while it runs.
    [[nodiscard]] std::optional<Error> exited();

private:
    class Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace hive
