// A drone as an object of a program that has a main function of its own: for other languages, and for programs that
// are more than a drone. Who writes a program that is a drone and nothing else takes run_drone().
#pragma once

#include <hive/drone.hpp>

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hive {

/// What a drone in somebody's program may do there; by default nothing that the program would notice.
struct EmbeddedOptions {
    std::string name;                      ///< in the swarm; empty: the kind
    std::vector<std::string> listen{};     ///< further addresses beside the local socket, "tcp://HOST:PORT"
    std::vector<std::string> advertise{};  ///< where others find it, if that is not where it listens
    bool insecure = false;                 ///< let `listen` take peers without a key
    std::filesystem::path key{};           ///< the swarm's key file; empty: $HIVE_KEY, or ~/.config/hive/swarm.key
    bool no_announce = false;              ///< on the local network, where it listens there
    bool remote_operator = false;          ///< members may set over the network what concerns this machine
    Json parameters = Json::object();
    /// What it receives, as --connect of a program has it: "image=camera.image,window=2".
    std::vector<std::string> connect{};
    std::optional<ExceptionPolicy> policy{};  ///< empty: as before a crash, or skip
    bool halted = false;                      ///< from the start
    bool signals = false;                     ///< SIGINT and SIGTERM end the drone
    bool ends_process = false;  ///< told to stop, but its code does not return within two seconds: the process ends
    Log log{};                  ///< gets the log lines of all levels, on any thread; empty: there is no log
};

/// Declare with drone(), then either run(), or start(), step() as often as wanted, and end(). All functions are for
/// the thread that calls these (the user thread).
class EmbeddedDrone {
public:
    /// Throws Errc::invalid_argument for a bad name, Errc::not_permitted for an unsafe address.
    EmbeddedDrone(DroneProgram program, EmbeddedOptions options);
    /// As run_drone() would: reads the command line that all drones share, and takes signals, log and the end of the
    /// process. Null: the line was answered or refused, and the program is to end with `exit_code`.
    static std::unique_ptr<EmbeddedDrone> from_command_line(int argc, const char* const* argv,
                                                            const DroneProgram& program, int& exit_code);
    ~EmbeddedDrone();  ///< a drone that runs ends, as a crash would end it: what it was told is remembered
    EmbeddedDrone(const EmbeddedDrone&) = delete;
    EmbeddedDrone& operator=(const EmbeddedDrone&) = delete;

    [[nodiscard]] Drone& drone() noexcept;
    [[nodiscard]] const std::string& name() const noexcept;
    /// What has been declared so far.
    [[nodiscard]] Interface interface() const;

    /// Runs until the drone is told to stop. For --describe: prints the interface and returns.
    void run();
    /// Meets the swarm. Throws Errc::name_taken, Errc::io, and what on_start throws.
    void start();
    /// Works for about so long, at least 1 ms. @return false when the drone was told to stop
    bool step(std::chrono::milliseconds time);
    /// Ends as the request `stop` would. Once more: nothing.
    void end();

private:
    struct Parts;
    explicit EmbeddedDrone(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

/// Where the runtime of another language may write its own stack in a crash, as text, before it calls the handler that
/// was there before its own: the trace in the log begins with it. Standard error, if no drone of this program traces
/// crashes. Call it after EmbeddedDrone::from_command_line().
int foreign_stack_descriptor() noexcept;

}  // namespace hive
