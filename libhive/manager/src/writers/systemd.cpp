// Writes units of the user's systemd: a service per drone, and a target per machine.
#include "../directory.hpp"
#include "../engines/engine.hpp"
#include "../engines/systemd_unit.hpp"
#include "command_lines.hpp"
#include "writer.hpp"

#include <set>

namespace hive {
namespace {

/// Most arguments need no quotes, and are easier to read without.
std::string readable_word(const std::string& word)
{
    constexpr std::string_view plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@:=,./+-";
    return !word.empty() && word.find_first_not_of(plain) == std::string::npos ? word : quoted_for_systemd(word);
}

/// Another machine may have Hive elsewhere: the $PATH of its user manager finds the program.
std::string exec_start(const SwarmDrone& drone, const std::vector<std::string>& words, const ExportOptions& options)
{
    const bool is_known = drone.host == Place::here && words.front().starts_with("hive-");
    std::string text = is_known ? readable_word(options.programs + "/" + words.front())
                                : "/usr/bin/env " + readable_word(words.front());
    for (std::size_t i = 1; i < words.size(); ++i)
        text += " " + readable_word(words[i]);
    return text;
}

std::string service(const SwarmPlan& plan, const SwarmDrone& drone, const std::string& command)
{
    std::string text = "[Unit]\nDescription=Hive drone " + drone.name + " of the swarm " + plan.name + "\nPartOf=hive-"
                       + plan.name
                       + ".target\nWants=network-online.target\nAfter=network-online.target\nStartLimitIntervalSec="
                         "60\nStartLimitBurst=5\n\n[Service]\n";
    for (const auto& property : unit_properties(drone))
        text += property + "\n";
    return text + "ExecStart=" + command + "\nRestart=" + restart_word(drone.restart) + "\nRestartSec=1\n";
}

std::string target(const SwarmPlan& plan, const std::vector<std::string>& services)
{
    std::string text = "# Put these files into ~/.config/systemd/user, then: systemctl --user enable --now hive-"
                       + plan.name + ".target\n[Unit]\nDescription=The swarm " + plan.name + "\n";
    for (const auto& name : services)
        text += "Wants=" + name + "\n";
    return text + "\n[Install]\nWantedBy=default.target\n";
}

}  // namespace

ExportedFiles write_systemd(const SwarmPlan& plan, const ExportOptions& options)
{
    const CommandLines lines(plan, CommandLines::Machines::as_planned);
    std::map<std::string, std::vector<const SwarmDrone*>> machines;
    for (const auto& drone : plan.drones)
        machines[drone.host].push_back(&drone);
    ExportedFiles files;
    for (const auto& [host, drones] : machines) {
        const std::string folder = machines.size() == 1 ? "" : machine_name(host) + "/";
        std::vector<std::string> services;
        ExportedFiles units;
        for (const auto* drone : drones) {
            services.push_back("hive-" + plan.name + "-" + drone->name + ".service");
            units.push_back(
                {folder + services.back(), service(plan, *drone, exec_start(*drone, lines.of(*drone), options))});
        }
        files.push_back({folder + "hive-" + plan.name + ".target", target(plan, services)});
        std::ranges::move(units, std::back_inserter(files));
    }
    return files;
}

}  // namespace hive
