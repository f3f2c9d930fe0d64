// Starts and stops the processes of drones on one machine; one file per kind of engine.
#pragma once

#include "../background_process.hpp"

#include <hive/process.hpp>
#include <hive/result.hpp>
#include <hive/start.hpp>
#include <hive/swarm.hpp>

#include <algorithm>
#include <chrono>
#include <deque>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hive {

/// begin() and poll() hardly block: one thread drives the engines of all machines in turn.
class Engine {
public:
    using Clock = platform::SteadyClock;

    /// The outcome of starting a drone.
    struct Report {
        std::string drone;
        /// Query the drone for whether it is ready. An error: it will not run; Errc::name_taken: one of this name is
        /// already running.
        Result<Started> started;
    };

    virtual ~Engine() = default;
    /// Throws if no drone can be started from here.
    virtual void require_usable() const {}
    /// Queues these drones, to be ready by then; poll() starts them a few at a time.
    virtual void begin(std::vector<SwarmDrone> drones, Clock::time_point until)
    {
        std::ranges::move(drones, std::back_inserter(waiting_));
        until_ = until;
    }
    /// New reports since the last call: one per drone of begin().
    virtual std::vector<Report> poll() = 0;
    /// One of these descriptors is readable when poll() may have a new report. Without any, poll() must be called
    /// regularly.
    [[nodiscard]] virtual std::vector<int> descriptors() { return {}; }
    /// Call it if a reported drone does not answer: poll() then reports its state again.
    virtual void look_again(const std::string& drone, const Error& why) = 0;
    /// An error of a drone of this engine, with advice for its machine.
    [[nodiscard]] virtual Error explained(const Error& error) const { return error; }
    /// The process of this machine that runs a drone of begin(); null if there is none.
    [[nodiscard]] virtual BackgroundProcess* process(const std::string&) { return nullptr; }
    /// Treats these as started by begin(), so that stop() stops them: an earlier process started them. Not needed on
    /// this machine, where Application::stop() kills hanging drones.
    virtual void adopt(const std::vector<std::string>&) {}
    /// Stops the drones of begin(), started or not. Returns by then, with the reason for each that has not exited.
    /// Leaves other drones alone, and a process that has begun to take over. Other engines may do the same on other
    /// threads.
    virtual std::vector<SwarmFailure> stop(const std::vector<std::string>& drones, Clock::time_point until) = 0;

protected:
    /// Removes queued drones.
    void forget_waiting(const std::vector<std::string>& drones)
    {
        std::erase_if(waiting_,
                      [&](const SwarmDrone& drone) { return std::ranges::find(drones, drone.name) != drones.end(); });
    }

    std::deque<SwarmDrone> waiting_;  ///< of begin(), not started yet
    Clock::time_point until_{};       ///< deadline of the last begin()
};

/// @param host  the machine's name in the plan
/// @param home  runtime directory of this machine's drones
std::unique_ptr<Engine> make_engine(const SwarmEngine& engine, const std::string& host,
                                    const std::filesystem::path& home);

/// Stops drones, each engine on a thread of its own, so that a machine that does not answer delays no other. Returns
/// those that cannot be stopped.
std::vector<SwarmFailure> stop_all(const std::map<Engine*, std::vector<std::string>>& drones,
                                   Engine::Clock::time_point until);

/// Adds the swarm, and --expect for each planned receiver of this drone whose ports are known.
SwarmDrone as_started(const SwarmPlan& plan, SwarmDrone drone);

inline bool takes_over(const SwarmDrone& drone) { return drone.take_over_s > 0; }
/// "face-1", or "the successor of face-1": the process's name in errors.
std::string subject_of(const SwarmDrone& drone);

/// The arguments of the drone's program.
std::vector<std::string> arguments_of(const SwarmDrone& drone);

/// Adds to a hivectl command those options of the drone's program that hivectl has too.
std::vector<std::string> with_order(std::vector<std::string> command, const SwarmDrone& drone);

/// "on-failure", "always", or the word for never.
std::string restart_word(Restart restart, const std::string& never = "no");
/// The text with this character twice wherever it stands, which is how many languages escape it.
std::string doubled(const std::string& text, char character);
/// "\x0a" for a line end, as bash and systemd read it.
std::string hex_escape(char byte);

/// The error with this exit code, among those of a drone that was not ready yet.
Errc errc_of_exit(int code);
/// The same from a status as of waitpid.
Errc errc_of_status(int status);
/// "its log says:" and the last lines of a process's log.
std::string log_text(const std::string& last_words);
/// The error of a drone that exited before it was ready, from its status as of waitpid.
Error not_ready(const std::string& drone, int status, const std::string& last_words);

std::unique_ptr<Engine> make_local_engine(const std::filesystem::path& home,
                                          BackgroundProcess::Life life = BackgroundProcess::Life::own);
/// Transient units of the user's systemd.
std::unique_ptr<Engine> make_systemd_engine(const std::filesystem::path& home);
/// @param settings  {"options": [further ones of srun]}
/// @param node      its name in Slurm
/// Outside of an allocation require_usable() and begin() throw Errc::refused.
std::unique_ptr<Engine> make_slurm_engine(const Json& settings, const std::string& node,
                                          const std::filesystem::path& home);
/// The options of srun for what the drone needs. Steps without an amount of processors or graphics cards share what
/// the allocation has.
std::vector<std::string> step_amounts(const SwarmDrone& drone);
/// @param settings  the ssh host: "lab-cam1"
std::unique_ptr<Engine> make_ssh_engine(const Json& settings, const std::filesystem::path& home);

}  // namespace hive
