// Starts and ends the processes of drones on one machine: one file for each way that people have to do that.
#pragma once

#include "../background_process.hpp"

#include <hive/process.hpp>
#include <hive/swarm.hpp>

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hive {

/// begin() and poll() wait for moments at most: one thread drives the engines of all machines in turn.
class Engine {
public:
    using Clock = std::chrono::steady_clock;

    /// What has become of a drone that was begun.
    struct Report {
        std::string drone;
        Place place{};                 ///< where it is met; whether it is ready yet, it says itself
        std::optional<Error> error{};  ///< it will not run; Errc::name_taken: one of this name does already
        bool found = false;            ///< it ran before it was begun
        std::string log{};             ///< on its machine; empty: not known
    };

    virtual ~Engine() = default;
    /// Takes the order to start these, to be ready by then; they are started a few at a time, while poll() is called.
    virtual void begin(std::vector<SwarmDrone> drones, Clock::time_point until) = 0;
    /// What is new since the last call: one report for each drone that was begun.
    virtual std::vector<Report> poll() = 0;
    /// One of these descriptors is readable when poll() may have something new. Without one, only looking tells.
    [[nodiscard]] virtual std::vector<int> descriptors() const { return {}; }
    /// A drone that was met does not answer: poll() is to report once more what has become of it.
    virtual void look_again(const std::string& drone, const Error& why) = 0;
    /// An error of a drone of this engine, with the advice that its machine calls for.
    [[nodiscard]] virtual Error explained(const Error& error) const { return error; }
    /// The process of this machine that runs a drone which was begun; null where there is none.
    [[nodiscard]] virtual BackgroundProcess* process(const std::string&) { return nullptr; }
    /// Counts these as begun, by an earlier process, so that stop() ends them. Drones of this machine need no engine
    /// for that: Application::stop() ends them, whatever they do.
    virtual void adopt(const std::vector<std::string>&) {}
    /// Ends what this engine began and what of it is still to be started. Returns by then, when it is gone, or tells
    /// why it is not; drones that it never began are left alone, and so is a process that has begun to take over. Other
    /// engines may be doing the same on other threads.
    virtual std::vector<SwarmFailure> stop(const std::vector<std::string>& drones, Clock::time_point until) = 0;
};

/// @param host  as the plan calls the machine
/// @param home  where drones of this machine meet
std::unique_ptr<Engine> make_engine(const SwarmEngine& engine, const std::string& host,
                                    const std::filesystem::path& home);

/// Ends drones, each engine on a thread of its own: a machine that does not answer takes the time of no other one. What
/// cannot be ended is told.
std::vector<SwarmFailure> stop_all(const std::map<Engine*, std::vector<std::string>>& drones,
                                   Engine::Clock::time_point until);

/// Adds the swarm, and --expect for each planned receiver of this drone whose ports are known.
SwarmDrone as_started(const SwarmPlan& plan, SwarmDrone drone);

inline bool takes_over(const SwarmDrone& drone) { return drone.take_over_s > 0; }
/// "face-1", or "the successor of face-1", as an error calls the process.
std::string subject_of(const SwarmDrone& drone);

/// The command line of the drone's program, but for its name.
std::vector<std::string> arguments_of(const SwarmDrone& drone);

/// The error that has this exit code, as far as a drone can have met it before it was ready.
Errc errc_of_exit(int code);
/// The same of a status as of waitpid.
Errc errc_of_status(int status);
/// "its log says:" and the last lines that a process wrote.
std::string log_text(const std::string& last_words);
/// Why a drone will not run whose process has ended so, as of waitpid.
Error not_ready(const std::string& drone, int status, const std::string& last_words);

std::unique_ptr<Engine> make_local_engine(const std::filesystem::path& home,
                                          BackgroundProcess::Life life = BackgroundProcess::Life::own);
/// Units of the user's systemd.
std::unique_ptr<Engine> make_systemd_engine(const std::filesystem::path& home);
/// @param settings  {"options": [further ones of srun]}
/// @param node      as Slurm calls it
/// Outside of an allocation begin() throws Errc::refused.
std::unique_ptr<Engine> make_slurm_engine(const Json& settings, const std::string& node,
                                          const std::filesystem::path& home);
/// @param settings  the machine as ssh knows it: "lab-cam1"
std::unique_ptr<Engine> make_ssh_engine(const Json& settings, const std::filesystem::path& home);

}  // namespace hive
