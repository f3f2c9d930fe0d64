// Runs the drones of this machine as units of the user's systemd, which restarts crashed ones.
#include "engine.hpp"

#include "../last_line.hpp"
#include "../running_command.hpp"
#include "systemd_unit.hpp"

#include <hive/event/home.hpp>
#include <hive/process.hpp>
#include <hive/program.hpp>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <deque>
#include <map>
#include <sstream>

namespace hive {
namespace {

using namespace std::chrono_literals;

constexpr std::ptrdiff_t units_at_once = 32;  ///< started and not yet reachable
constexpr std::size_t journal_lines = 15;
constexpr auto patience_of_systemd = 30s;  ///< per call of systemctl
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
        LogFromNow log;
        bool met = false;  ///< reported
    };
    using Words = std::vector<std::string>;

    void write_next(std::vector<Report>& reports);
    void require_free(const std::string& drone) const;
    void write(const SwarmDrone& drone);
    void call(std::vector<Report>& reports);
    void look(std::vector<Report>& reports);
    void hear(const std::map<std::string, std::string>& said, std::vector<Report>& reports);
    void fail_all(const Error& error, std::vector<Report>& reports);
    [[nodiscard]] Words names_not_met() const;

    event::Home home_;
    std::deque<SwarmDrone> waiting_;
    std::map<std::string, Unit> units_;
    std::deque<Words> calls_;  ///< pending
    std::optional<RunningCommand> calling_, asking_;
    Clock::time_point next_look_{};
};

std::vector<std::string> systemctl(std::vector<std::string> words)
{
    words.insert(words.begin(), {"systemctl", "--user"});
    return words;
}

std::filesystem::path unit_directory()
{
    const auto variable = [](const char* name) { return std::string(std::getenv(name) ? std::getenv(name) : ""); };
    const auto config = variable("XDG_CONFIG_HOME");
    return (config.empty() ? std::filesystem::path(variable("HOME")) / ".config" : std::filesystem::path(config))
           / "systemd" / "user";
}

/// "KEY=VALUE" lines, one block per unit, separated by empty lines.
std::vector<std::map<std::string, std::string>> properties_in(const std::string& text)
{
    std::vector<std::map<std::string, std::string>> units(1);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (line.empty())
            units.emplace_back();
        else if (const auto equals = line.find('='); equals != std::string::npos)
            units.back()[line.substr(0, equals)] = line.substr(equals + 1);
    return units;
}

std::vector<Engine::Report> SystemdEngine::poll()
{
    std::vector<Report> reports;
    for (auto& [name, unit] : units_)
        if (!unit.met && home_.alive(name)) {
            unit.met = true;
            reports.push_back({.drone = name,
                               .place = {.drone = name, .host = Place::here, .address = to_text(home_.address(name))}});
        }
    call(reports);
    if (!calling_ && calls_.empty())
        look(reports);
    write_next(reports);
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
    for (const auto* command : {&calling_, &asking_})
        if (*command)
            std::ranges::copy((*command)->descriptors(), std::back_inserter(all));
    return all;
}

/// A few units at a time, so that the first ones are ready soon.
void SystemdEngine::write_next(std::vector<Report>& reports)
{
    Words started{"start", "--no-block"};
    while (!waiting_.empty() && std::ssize(names_not_met()) < units_at_once) {
        const auto drone = std::move(waiting_.front());
        waiting_.pop_front();
        try {
            if (home_.alive(drone.name))
                throw Error(Errc::name_taken, drone.name + " runs already");
            require_free(drone.name);
            write(drone);
            started.push_back(unit_name(drone.name));
        } catch (const Error& error) {
            reports.push_back({.drone = drone.name, .error = error});
        }
    }
    if (started.size() > 2)
        calls_.insert(calls_.end(), {{"daemon-reload"}, started});
}

/// A user's units are shared by all homes.
void SystemdEngine::require_free(const std::string& drone) const
{
    const auto unit = unit_directory() / unit_name(drone);
    std::ostringstream text;
    text << std::ifstream(unit).rdbuf();
    const auto own = environment_line("HIVE_HOME=" + home_.directory().string());
    if (text.str().empty() || text.str().find(own) != std::string::npos)
        return;
    const auto state = run_command(systemctl({"is-active", unit_name(drone)}), patience_of_systemd).out;
    if (!state.starts_with("inactive") && !state.starts_with("failed") && !state.starts_with("unknown"))
        throw Error(Errc::refused, unit_name(drone) + " runs already, of another home",
                    "stop that first: hivectl down with its HIVE_HOME, or systemctl --user stop " + unit_name(drone));
}

void SystemdEngine::write(const SwarmDrone& drone)
{
    auto command = command_of(drone.kind);
    std::ranges::move(arguments_of(drone), std::back_inserter(command.arguments));
    command.environment.push_back("HIVE_HOME=" + home_.directory().string());
    for (const std::string variable : {"HIVE_KEY", "XDG_CONFIG_HOME"})  // where the key is
        if (const char* const value = std::getenv(variable.c_str()))
            command.environment.push_back(variable + "=" + value);
    LogFromNow from_now(home_.path(drone.name, ".log"));
    const auto text = unit_text(drone, command, from_now.file());
    std::error_code problem;
    std::filesystem::create_directories(unit_directory(), problem);
    event::replace_file(unit_directory() / unit_name(drone.name), text);
    units_.insert_or_assign(drone.name, Unit{.log = std::move(from_now)});
}

/// Runs the calls one after the other; if one fails, all units that are not reachable yet fail.
void SystemdEngine::call(std::vector<Report>& reports)
try {
    if (!calling_ && !calls_.empty()) {
        calling_.emplace(systemctl(calls_.front()), patience_of_systemd);
        calls_.pop_front();
    }
    const auto result = calling_ ? calling_->poll() : std::nullopt;
    if (!result)
        return;
    calling_.reset();
    if (result->exit_code != 0)
        throw Error(Errc::failed, "systemctl --user: " + last_line(result->err));
} catch (const Error& error) {
    fail_all(error, reports);
}

void SystemdEngine::fail_all(const Error& error, std::vector<Report>& reports)
{
    calls_.clear();
    for (const auto& name : names_not_met()) {
        units_.at(name).met = true;
        reports.push_back({.drone = name, .error = error});
    }
}

/// Finds starting units on which systemd has given up.
void SystemdEngine::look(std::vector<Report>& reports)
try {
    if (!asking_ && Clock::now() >= next_look_) {
        Words words{"show", "--property=Id,ActiveState,ExecMainCode,ExecMainStatus"};
        for (const auto& name : names_not_met())
            words.push_back(unit_name(name));
        if (words.size() > 2)
            asking_.emplace(systemctl(words), patience_of_systemd);
        next_look_ = Clock::now() + pause_between_looks;
    }
    const auto result = asking_ ? asking_->poll() : std::nullopt;
    if (!result)
        return;
    asking_.reset();
    for (const auto& said : properties_in(result->out))
        hear(said, reports);
} catch (const Error& error) {
    fail_all(error, reports);
}

void SystemdEngine::hear(const std::map<std::string, std::string>& said, std::vector<Report>& reports)
{
    const auto value = [&](const char* key) { return said.contains(key) ? said.at(key) : std::string(); };
    const auto number = [&](const char* key) { return std::atoi(value(key).c_str()); };
    const auto found =
        std::ranges::find_if(units_, [&](const auto& entry) { return unit_name(entry.first) == value("Id"); });
    const bool over = value("ActiveState") == "failed"
                      || (value("ActiveState") == "inactive" && number("ExecMainCode") != 0);  // 0: not started yet
    if (found == units_.end() || found->second.met || !over)
        return;
    constexpr int exited = 1;  // CLD_EXITED; otherwise the status is a signal
    const int status = number("ExecMainCode") == exited ? number("ExecMainStatus") << 8 : number("ExecMainStatus");
    auto& [name, unit] = *found;
    unit.met = true;
    reports.push_back({.drone = name, .error = not_ready(name, status, unit.log.last_lines(journal_lines))});
}

std::vector<std::string> SystemdEngine::names_not_met() const
{
    Words names;
    for (const auto& [name, unit] : units_)
        if (!unit.met)
            names.push_back(name);
    return names;
}

/// Removes their units, too.
std::vector<SwarmFailure> SystemdEngine::stop(const std::vector<std::string>& drones, Clock::time_point)
{
    std::erase_if(waiting_,
                  [&](const SwarmDrone& drone) { return std::ranges::find(drones, drone.name) != drones.end(); });
    calls_.clear();
    calling_.reset();
    Words words{"stop"}, ours;
    for (const auto& name : drones)
        if (units_.contains(name)) {
            ours.push_back(name);
            words.push_back(unit_name(name));
        }
    if (ours.empty())
        return {};
    std::optional<Error> failed;
    try {
        run_command(systemctl(words), patience_of_systemd);
    } catch (const Error& error) {
        failed = error;
    }
    std::vector<SwarmFailure> remains;
    std::error_code ignored;
    for (const auto& name : ours) {
        if (home_.alive(name)) {
            remains.push_back(
                {name, failed.value_or(Error(Errc::failed, "systemd has not stopped " + unit_name(name)))});
            continue;
        }
        std::filesystem::remove(unit_directory() / unit_name(name), ignored);
        units_.erase(name);
    }
    if (!failed)
        run_command(systemctl({"daemon-reload"}), patience_of_systemd);
    return remains;
}

}  // namespace

std::unique_ptr<Engine> make_systemd_engine(const std::filesystem::path& home)
{
    return std::make_unique<SystemdEngine>(home);
}

}  // namespace hive
