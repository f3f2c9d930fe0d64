// Runs the drones of this machine as transient units of the user's systemd, which restarts crashed ones.
#include "engine.hpp"

#include "../last_line.hpp"
#include "../running_command.hpp"
#include "systemd_unit.hpp"

#include <hive/event/home.hpp>
#include <hive/program.hpp>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <map>
#include <sstream>
#include <utility>

namespace hive {
namespace {

using namespace std::chrono_literals;

constexpr std::ptrdiff_t units_at_once = 32;  ///< started and not yet reachable
constexpr std::size_t journal_lines = 15;
constexpr auto start_timeout = 310s;     ///< of systemd-run, which waits for TimeoutStartSec
constexpr auto systemctl_timeout = 30s;  ///< per call
constexpr auto pause_between_looks = 200ms;

class SystemdEngine final : public Engine {
public:
    explicit SystemdEngine(std::filesystem::path home) : home_(std::move(home)) {}

    void begin(std::vector<SwarmDrone> drones, Clock::time_point) override
    {
        std::ranges::move(drones, std::back_inserter(waiting_));
    }
    std::vector<Report> poll() override;
    [[nodiscard]] std::vector<int> descriptors() override;
    void look_again(const std::string& drone, const Error& why) override;
    std::vector<SwarmFailure> stop(const std::vector<std::string>& drones, Clock::time_point until) override;

private:
    struct Unit {
        explicit Unit(LogFromNow from_now) : log(std::move(from_now)) {}

        LogFromNow log;
        std::optional<RunningCommand> start;  ///< exits when the drone is ready or has failed
        bool met = false;                     ///< reported
        Clock::time_point next_look{};
    };

    void start_next(std::vector<Report>& reports);
    void start(const SwarmDrone& drone);
    [[nodiscard]] std::string description(const std::string& drone) const;
    [[nodiscard]] std::optional<Report> look(const std::string& drone, Unit& unit) const;
    [[nodiscard]] std::optional<Error> failure(const std::string& drone, const Unit& unit, bool at_start) const;

    event::Home home_;
    std::deque<SwarmDrone> waiting_;
    std::map<std::string, Unit> units_;
};

/// @param words  the verb and its options; the units of the drones follow
CommandResult systemctl(std::vector<std::string> words, const std::vector<std::string>& drones)
{
    words.insert(words.begin(), {"systemctl", "--user"});
    std::ranges::transform(drones, std::back_inserter(words), unit_name);
    return run_command(words, systemctl_timeout);
}

using Properties = std::map<std::string, std::string>;

/// What systemd knows, by unit: it prints KEY=VALUE lines, and an empty line between two units.
std::map<std::string, Properties> units_of(const std::vector<std::string>& drones)
{
    std::map<std::string, Properties> units;
    std::istringstream lines(
        systemctl({"show", "--property=Id,Description,FragmentPath,ActiveState,ExecMainCode,ExecMainStatus"}, drones)
            .out
        + "\n");
    Properties unit;
    for (std::string line; std::getline(lines, line);)
        if (const auto equals = line.find('='); equals != std::string::npos) {
            unit[line.substr(0, equals)] = line.substr(equals + 1);
        } else {
            const auto id = unit["Id"];
            units[id] = std::exchange(unit, {});
        }
    return units;
}

std::vector<Engine::Report> SystemdEngine::poll()
{
    std::vector<Report> reports;
    for (auto& [name, unit] : units_)
        if (auto report = unit.met ? std::nullopt : look(name, unit)) {
            unit.met = true;
            reports.push_back(*std::move(report));
        }
    start_next(reports);
    return reports;
}

void SystemdEngine::look_again(const std::string& drone, const Error&)
{
    if (const auto found = units_.find(drone); found != units_.end())
        found->second.met = false;
}

std::vector<int> SystemdEngine::descriptors()
{
    std::vector<int> all;
    for (const auto& [name, unit] : units_)
        if (unit.start && !unit.met)
            std::ranges::copy(unit.start->descriptors(), std::back_inserter(all));
    return all;
}

/// A few units at a time, so that the first ones are ready soon.
void SystemdEngine::start_next(std::vector<Report>& reports)
{
    auto places = units_at_once - std::ranges::count_if(units_, [](const auto& entry) { return !entry.second.met; });
    std::vector<std::string> next;
    for (std::size_t i = 0; i < waiting_.size() && std::ssize(next) < places; ++i)
        next.push_back(waiting_[i].name);
    std::optional<Error> unusable;
    try {
        auto known = next.empty() ? std::map<std::string, Properties>() : units_of(next);
        std::erase_if(next,
                      [&](const auto& drone) { return known[unit_name(drone)]["Description"] != description(drone); });
        if (!next.empty())
            systemctl({"reset-failed"}, next);  // failed units of an earlier run are still loaded
    } catch (const Error& error) {
        unusable = error;
    }
    for (; !waiting_.empty() && places > 0; waiting_.pop_front(), --places)
        try {
            if (unusable)
                throw Error(*unusable);
            start(waiting_.front());
        } catch (const Error& error) {
            reports.push_back({.drone = waiting_.front().name, .error = error});
        }
}

/// Distinguishes our units from those of another home: all homes of a user share one systemd.
std::string SystemdEngine::description(const std::string& drone) const
{
    return "Hive drone " + drone + " of " + home_.directory().string();
}

void SystemdEngine::start(const SwarmDrone& drone)
{
    if (home_.alive(drone.name))
        throw Error(Errc::name_taken, drone.name + " runs already");
    if (drone.restart == Restart::always)
        throw restart_refused(drone.name);
    auto command = command_of(drone.kind);
    std::ranges::move(arguments_of(drone), std::back_inserter(command.arguments));
    command.environment.push_back("HIVE_HOME=" + home_.directory().string());
    for (const std::string variable : {"HIVE_KEY", "XDG_CONFIG_HOME"})  // where the key is
        if (const char* const value = std::getenv(variable.c_str()))
            command.environment.push_back(variable + "=" + value);
    LogFromNow from_now(home_.path(drone.name, ".log"));

    auto properties = unit_properties(drone);
    for (const std::string stream : {"StandardOutput", "StandardError"})
        properties.push_back(stream + "=append:" + from_now.file().string());
    properties.insert(properties.end(), {"StartLimitIntervalSec=60", "StartLimitBurst=5", "RestartSec=1",
                                         "Restart=" + restart_word(drone.restart)});
    std::vector<std::string> words{"systemd-run", "--user", "--unit=" + unit_name(drone.name),
                                   "--description=" + description(drone.name)};
    for (const auto& property : properties)
        words.push_back("--property=" + property);
    for (const auto& variable : command.environment)
        words.push_back("--setenv=" + variable);
    words.insert(words.end(), {"--", command.program.string()});
    for (const auto& argument : command.arguments)
        words.push_back(doubled(argument, '$'));  // a $ would start a variable
    units_.erase(drone.name);
    units_.try_emplace(drone.name, std::move(from_now)).first->second.start.emplace(words, start_timeout);
}

std::optional<Engine::Report> SystemdEngine::look(const std::string& drone, Unit& unit) const
try {
    const auto result = unit.start ? unit.start->poll() : std::nullopt;
    if (result)
        unit.start.reset();
    if (result && result->exit_code != 0)
        throw failure(drone, unit, true).value_or(Error(Errc::failed, "systemd-run: " + last_line(result->err)));
    if (home_.alive(drone))
        return Report{.drone = drone,
                      .place = {.drone = drone, .host = Place::here, .address = to_text(home_.address(drone))}};
    if (unit.start || Clock::now() < unit.next_look)
        return std::nullopt;
    unit.next_look = Clock::now() + pause_between_looks;
    const auto error = failure(drone, unit, false);
    return error ? std::optional(Report{.drone = drone, .error = error}) : std::nullopt;
} catch (const Error& error) {
    return Report{.drone = drone, .error = error};
}

/// Why the unit does not run our drone, as far as systemd knows. A crash is final at the start only: later, systemd may
/// still restart it.
std::optional<Error> SystemdEngine::failure(const std::string& drone, const Unit& unit, bool at_start) const
{
    auto known = units_of({drone})[unit_name(drone)];
    if (const auto& file = known["FragmentPath"]; !file.empty() && file.find("/transient/") == std::string::npos)
        return Error(Errc::refused, unit_name(drone) + " has a unit file, " + file,
                     "remove it: rm " + file + " && systemctl --user daemon-reload");
    const bool loaded = known["ActiveState"] == "active" || known["ActiveState"] == "activating";
    if (loaded && known["Description"] != description(drone))
        return Error(Errc::refused, unit_name(drone) + " runs already, of another home",
                     "stop that first: hivectl down with its HIVE_HOME, or systemctl --user stop " + unit_name(drone));
    const int code = std::atoi(known["ExecMainCode"].c_str()), value = std::atoi(known["ExecMainStatus"].c_str());
    if (code == 0 || (loaded && !at_start))
        return std::nullopt;
    constexpr int exited = 1;  // CLD_EXITED; otherwise the status is a signal
    return not_ready(drone, code == exited ? value << 8 : value, unit.log.last_lines(journal_lines));
}

/// Leaves units of another home alone.
std::vector<SwarmFailure> SystemdEngine::stop(const std::vector<std::string>& drones, Clock::time_point)
{
    const auto meant = [&](const SwarmDrone& drone) { return std::ranges::find(drones, drone.name) != drones.end(); };
    std::erase_if(waiting_, meant);
    std::vector<std::string> begun, loaded;
    std::ranges::copy_if(drones, std::back_inserter(begun), [&](const auto& name) { return units_.contains(name); });
    for (const auto& name : begun)
        units_.at(name).start.reset();
    std::optional<Error> failed;
    try {
        auto known = begun.empty() ? std::map<std::string, Properties>() : units_of(begun);
        std::ranges::copy_if(begun, std::back_inserter(loaded), [&](const auto& name) {
            return known[unit_name(name)]["Description"] == description(name);
        });
        for (const auto* verb : {"stop", "reset-failed"})  // a failed unit would stay loaded
            if (!loaded.empty())
                systemctl({verb}, loaded);
    } catch (const Error& error) {
        failed = error;
    }
    std::vector<SwarmFailure> remains;
    for (const auto& name : begun)
        if (home_.alive(name))
            remains.push_back(
                {name, failed.value_or(Error(Errc::failed, "systemd has not stopped " + unit_name(name)))});
        else
            units_.erase(name);
    return remains;
}

}  // namespace

std::unique_ptr<Engine> make_systemd_engine(const std::filesystem::path& home)
{
    return std::make_unique<SystemdEngine>(home);
}

}  // namespace hive
