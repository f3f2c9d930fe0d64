// Runs the drones of this machine as transient units of the user's systemd, which restarts crashed ones.
#include "engine.hpp"

#include "../last_line.hpp"
#include "../running_command.hpp"
#include "systemd_unit.hpp"

#include <hive/event/home.hpp>
#include <hive/program.hpp>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <sstream>
#include <utility>

namespace hive {
namespace {

using namespace std::chrono_literals;

constexpr std::ptrdiff_t units_at_once = 32;  ///< started and not yet reachable
constexpr auto start_timeout = 310s;          ///< of systemd-run, which waits for TimeoutStartSec
constexpr auto min_systemctl_time = 3s;
constexpr auto min_stop_time = 10s;       ///< of systemctl stop, which waits until the drones have exited
constexpr auto max_systemctl_time = 30s;  ///< per call, whatever is left of the verb's time
constexpr auto report_time = 1s;          ///< so that a missing answer is reported before the deadline
constexpr auto pause_between_looks = 200ms;

using Properties = std::map<std::string, std::string>;

class SystemdEngine final : public Engine {
public:
    explicit SystemdEngine(std::filesystem::path home) : home_(std::move(home)) {}

    std::vector<Report> poll() override;
    [[nodiscard]] std::vector<int> descriptors() override;
    void look_again(const std::string& drone, const Error& why) override;
    std::vector<SwarmFailure> stop(const std::vector<std::string>& drones, Clock::time_point until) override;

private:
    struct Unit {
        explicit Unit(LogFromNow from_now) : log(std::move(from_now)) {}

        LogFromNow log;
        std::optional<RunningCommand> start;  ///< exits when the drone is ready or has failed
        std::optional<Error> refused{};       ///< of systemd-run
        bool met = false;                     ///< reported
        Clock::time_point next_look{};
    };

    void on_systemctl(std::vector<Report>& reports);
    void call_systemctl(std::vector<Report>& reports);
    void start_checked(const std::vector<std::string>& drones, std::vector<Report>& reports);
    void start(const SwarmDrone& drone);
    void fail(const std::vector<std::string>& drones, const Error& error, std::vector<Report>& reports);
    [[nodiscard]] bool is_waiting(const std::string& drone) const;
    [[nodiscard]] std::string description(const std::string& drone) const;
    [[nodiscard]] std::optional<Report> look(const std::string& drone, Unit& unit) const;
    [[nodiscard]] std::optional<Error> failure(const std::string& drone, const Unit& unit,
                                               const Properties& known) const;

    event::Home home_;
    std::map<std::string, Unit> units_;
    std::optional<RunningCommand> systemctl_;  ///< one call for all drones of asked_: show, or then reset-failed
    std::vector<std::string> asked_;
    bool is_reset_ = false;
};

/// @param words  the verb and its options; the units of the drones follow
std::vector<std::string> systemctl_words(std::vector<std::string> words, const std::vector<std::string>& drones)
{
    words.insert(words.begin(), {"systemctl", "--user"});
    std::ranges::transform(drones, std::back_inserter(words), unit_name);
    return words;
}

std::vector<std::string> show_words(const std::vector<std::string>& drones)
{
    return systemctl_words({"show", "--property=Id,Description,FragmentPath,ActiveState,ExecMainCode,ExecMainStatus"},
                           drones);
}

/// What `show` printed, by unit: KEY=VALUE lines, and an empty line between two units.
std::map<std::string, Properties> units_in(const std::string& shown)
{
    std::map<std::string, Properties> units;
    std::istringstream lines(shown + "\n");
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

std::chrono::milliseconds systemctl_time(Engine::Clock::time_point until)
{
    return std::clamp<std::chrono::milliseconds>(
        std::chrono::ceil<std::chrono::milliseconds>(until - Engine::Clock::now()), min_systemctl_time,
        max_systemctl_time);
}

Error no_answer() { return {Errc::timeout, "systemctl --user does not answer", "see: systemctl --user status"}; }

std::vector<Engine::Report> SystemdEngine::poll()
{
    std::vector<Report> reports;
    on_systemctl(reports);
    for (auto& [name, unit] : units_)
        if (auto report = unit.met ? std::nullopt : look(name, unit)) {
            unit.met = true;
            reports.push_back(*std::move(report));
        }
    if (!systemctl_)
        call_systemctl(reports);
    return reports;
}

void SystemdEngine::look_again(const std::string& drone, const Error&)
{
    if (const auto found = units_.find(drone); found != units_.end())
        found->second.met = false;
}

std::vector<int> SystemdEngine::descriptors()
{
    auto all = systemctl_ ? systemctl_->descriptors() : std::vector<int>();
    for (const auto& [name, unit] : units_)
        if (unit.start && !unit.met)
            std::ranges::copy(unit.start->descriptors(), std::back_inserter(all));
    return all;
}

/// Queries the units that are not up, and those of the next drones: a few at a time, so that the first ones are ready
/// soon.
void SystemdEngine::call_systemctl(std::vector<Report>& reports)
{
    const auto now = Clock::now();
    auto places = units_at_once;
    asked_.clear();
    for (const auto& [name, unit] : units_) {
        places -= unit.met ? 0 : 1;
        if (!unit.met && !unit.start && now >= unit.next_look)
            asked_.push_back(name);
    }
    for (std::size_t i = 0; i < waiting_.size() && places > 0; ++i, --places)
        asked_.push_back(waiting_[i].name);
    try {
        if (!asked_.empty())
            systemctl_.emplace(show_words(asked_), systemctl_time(until_ - report_time));
    } catch (const Error& error) {
        fail(asked_, error, reports);
    }
}

void SystemdEngine::on_systemctl(std::vector<Report>& reports)
try {
    const auto result = systemctl_ ? systemctl_->poll() : std::nullopt;
    if (!result)
        return;
    systemctl_.reset();
    const bool was_reset = std::exchange(is_reset_, false);
    if (result->late)
        return fail(asked_, no_answer(), reports);
    if (was_reset)
        return start_checked(asked_, reports);
    auto known = units_in(result->out);
    std::vector<std::string> next, loaded;
    for (const auto& drone : asked_) {
        const auto& unit = known[unit_name(drone)];
        if (is_waiting(drone)) {
            next.push_back(drone);
            if (const auto found = unit.find("Description"); found != unit.end() && found->second == description(drone))
                loaded.push_back(drone);
        } else if (const auto begun = units_.find(drone); begun != units_.end()) {
            begun->second.next_look = Clock::now() + pause_between_looks;
            if (const auto error = failure(drone, begun->second, unit))
                fail({drone}, *error, reports);
        }
    }
    if (loaded.empty())
        return start_checked(next, reports);
    asked_ = std::move(next);
    // An earlier run has left some failed units.
    systemctl_.emplace(systemctl_words({"reset-failed"}, loaded), systemctl_time(until_ - report_time));
    is_reset_ = true;
} catch (const Error& error) {
    fail(asked_, error, reports);
}

bool SystemdEngine::is_waiting(const std::string& drone) const
{
    return std::ranges::find(waiting_, drone, &SwarmDrone::name) != waiting_.end();
}

/// Reports the error of each that has no report yet.
void SystemdEngine::fail(const std::vector<std::string>& drones, const Error& error, std::vector<Report>& reports)
{
    for (const auto& drone : drones) {
        const auto unit = units_.find(drone);
        const bool begun = std::erase_if(waiting_, [&](const auto& next) { return next.name == drone; }) == 0;
        if (begun && (unit == units_.end() || std::exchange(unit->second.met, true)))
            continue;
        reports.push_back({drone, error});
    }
}

void SystemdEngine::start_checked(const std::vector<std::string>& drones, std::vector<Report>& reports)
{
    for (const auto& name : drones)
        try {
            if (const auto next = std::ranges::find(waiting_, name, &SwarmDrone::name); next != waiting_.end()) {
                start(*next);
                waiting_.erase(next);
            }
        } catch (const Error& error) {
            fail({name}, error, reports);
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
    if (result) {
        unit.start.reset();
        if (result->exit_code != 0)
            unit.refused = Error(Errc::failed, "systemd-run: " + last_line(result->err));
    }
    if (!unit.refused && home_.alive(drone))
        return Report{
            drone, Started{.place = {.drone = drone, .host = Place::here, .address = to_text(home_.address(drone))}}};
    return std::nullopt;
} catch (const Error& error) {
    return Report{drone, error};
}

/// Why the unit does not run our drone, as far as systemd knows. A crash is final at the start only: later, systemd may
/// still restart it.
std::optional<Error> SystemdEngine::failure(const std::string& drone, const Unit& unit, const Properties& known) const
{
    const auto value = [&](const char* name) {
        const auto found = known.find(name);
        return found == known.end() ? "" : found->second;
    };
    if (const auto file = value("FragmentPath"); !file.empty() && file.find("/transient/") == std::string::npos)
        return Error(Errc::refused, unit_name(drone) + " has a unit file, " + file,
                     "remove it: rm " + file + " && systemctl --user daemon-reload");
    const bool loaded = value("ActiveState") == "active" || value("ActiveState") == "activating";
    if (loaded && value("Description") != description(drone))
        return Error(Errc::refused, unit_name(drone) + " runs already, of another home",
                     "stop that first: hivectl down with its HIVE_HOME, or systemctl --user stop " + unit_name(drone));
    const int code = std::atoi(value("ExecMainCode").c_str()), status = std::atoi(value("ExecMainStatus").c_str());
    if (code == 0 || (loaded && !unit.refused))
        return unit.refused;
    constexpr int exited = 1;  // CLD_EXITED; otherwise the status is a signal
    return not_ready(drone, code == exited ? status << 8 : status, unit.log.last_lines());
}

/// Leaves units of another home alone.
std::vector<SwarmFailure> SystemdEngine::stop(const std::vector<std::string>& drones, Clock::time_point until)
{
    forget_waiting(drones);
    std::vector<std::string> begun, loaded;
    std::ranges::copy_if(drones, std::back_inserter(begun), [&](const auto& name) { return units_.contains(name); });
    for (const auto& name : begun)
        units_.at(name).start.reset();
    std::optional<Error> failed;
    const auto call = [&](const std::vector<std::string>& words, std::chrono::milliseconds at_least) {
        auto result = run_command(words, std::max(systemctl_time(until), at_least));
        if (result.late)
            throw no_answer();
        return result.out;
    };
    try {
        auto known = units_in(begun.empty() ? "" : call(show_words(begun), min_systemctl_time));
        std::ranges::copy_if(begun, std::back_inserter(loaded), [&](const auto& name) {
            return known[unit_name(name)]["Description"] == description(name);
        });
        for (const auto* verb : {"stop", "reset-failed"})  // a failed unit would stay loaded
            if (!loaded.empty())
                call(systemctl_words({verb}, loaded), min_stop_time);
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
