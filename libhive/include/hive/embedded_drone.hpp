// A drone as an object of a program with its own main function: for other languages, and for programs that are more
// than a drone. A program that is only a drone uses run_drone().
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

/// The settings of an embedded drone; by default it does not affect the rest of the program.
struct EmbeddedOptions {
    std::string name;                      ///< in the swarm; empty: the kind
    std::vector<std::string> listen{};     ///< addresses besides the local socket, "tcp://HOST:PORT"
    std::vector<std::string> advertise{};  ///< addresses for other machines, if they differ from `listen`
    bool insecure = false;                 ///< `listen` accepts peers without a key
    std::filesystem::path key{};           ///< the swarm's key file; empty: $HIVE_KEY, or ~/.config/hive/swarm.key
    bool no_announce = false;              ///< do not announce it on the local network
    bool remote_operator = false;          ///< members may set parameters that affect this machine over the network
    Json parameters = Json::object();
    /// Its connections, written as for --connect: "image=camera.image,window=2".
    std::vector<std::string> connect{};
    std::optional<ExceptionPolicy> policy{};  ///< empty: as before a crash, or skip
    bool halted = false;                      ///< starts halted
    bool signals = false;                     ///< SIGINT and SIGTERM stop the drone
    bool ends_process = false;  ///< exits the process if the drone's code does not return within 2 s of a stop
    Log log{};                  ///< gets the log lines of all levels, on any thread; empty: no log
};

/// Declare with drone(), then either run(), or start(), step() as often as wanted, and end(). All functions are for
/// the thread that calls these (the user thread).
class EmbeddedDrone {
public:
    /// Throws Errc::invalid_argument for a bad name, Errc::not_permitted for an unsafe address.
    EmbeddedDrone(DroneProgram program, EmbeddedOptions options);
    /// As run_drone(): reads the command line that all drones share, and handles signals, the log and the exit of the
    /// process. Null: the command line was answered or refused, and the program has to exit with `exit_code`.
    static std::unique_ptr<EmbeddedDrone> from_command_line(int argc, const char* const* argv,
                                                            const DroneProgram& program, int& exit_code);
    ~EmbeddedDrone();  ///< a running drone ends as in a crash: its saved state is kept
    EmbeddedDrone(const EmbeddedDrone&) = delete;
    EmbeddedDrone& operator=(const EmbeddedDrone&) = delete;

    [[nodiscard]] Drone& drone() noexcept;
    [[nodiscard]] const std::string& name() const noexcept;
    /// The declarations so far.
    [[nodiscard]] Interface interface() const;

    /// Runs until the drone is told to stop. For --describe: prints the interface and returns.
    void run();
    /// Joins the swarm. Throws Errc::name_taken, Errc::io, and what on_start throws.
    void start();
    /// Works for about this long, at least 1 ms. @return false when the drone was told to stop
    bool step(std::chrono::milliseconds time);
    /// Stops as the request `stop` would. A second call does nothing.
    void end();

private:
    struct Parts;
    explicit EmbeddedDrone(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

/// The descriptor to which another language's runtime may write its own stack in a crash, as text, before it calls the
/// previous handler: the trace in the log begins with that text. Standard error, if no drone of this program traces
/// crashes. Call it after EmbeddedDrone::from_command_line().
int foreign_stack_descriptor() noexcept;

}  // namespace hive
