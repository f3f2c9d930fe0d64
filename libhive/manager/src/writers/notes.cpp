// Lists what drones need and no form contains: Python files, files that they read or write, devices.
#include <hive/printable.hpp>
#include <hive/program.hpp>
#include <hive/swarm_export.hpp>

#include <algorithm>
#include <filesystem>

namespace hive {
namespace {

namespace fs = std::filesystem;

bool is_device(const std::string& text) { return text.starts_with("/dev/"); }

bool is_file(const std::string& text)
{
    std::error_code ignored;
    const auto begins = [&](const char* with) { return text.starts_with(with); };
    return begins("/") || begins("./") || begins("../") || begins("~/") || fs::is_regular_file(text, ignored);
}

bool in_containers(std::string_view form) { return form == "compose" || form == "kubernetes"; }

/// What is missing where the form runs the drone, and the remedy; empty: nothing.
std::string lack_of(const SwarmDrone& drone, const std::string& thing, std::string_view form)
{
    if (form == "compose" && is_device(thing))
        return {};  // it is in the file
    if (in_containers(form))
        return is_device(thing) ? "which a pod does not have: add a hostPath volume and privileged: true, or a device "
                                  "plugin"
                                : "which is not in the image: add it there, or as a volume";
    if (is_device(thing) || (drone.host == Place::here && (form == "shell" || thing.starts_with("/"))))
        return {};
    const std::string there = drone.host == Place::here ? "it has to be there" : "it has to be on " + drone.host;
    if (thing.starts_with("/"))
        return there;
    return there + ", seen from " + (form == "systemd" ? "the user's home directory" : "where the script is called");
}

struct Need {
    std::string thing, lack;
    std::vector<std::string> drones;
};

void add(std::vector<Need>& needs, const SwarmDrone& drone, const std::string& thing, std::string_view form)
{
    const auto lack = lack_of(drone, thing, form);
    if (lack.empty())
        return;
    const auto same =
        std::ranges::find_if(needs, [&](const Need& need) { return need.thing == thing && need.lack == lack; });
    if (same != needs.end())
        same->drones.push_back(drone.name);
    else
        needs.push_back({thing, lack, {drone.name}});
}

std::string text_of(const Need& need)
{
    const auto others = need.drones.size() - 1;
    return printable(need.drones.front() + (others == 0 ? " needs " : " and " + std::to_string(others) + " more need ")
                     + need.thing + ", " + need.lack);
}

}  // namespace

std::vector<std::string> export_notes(const SwarmPlan& plan, std::string_view form)
{
    std::vector<Need> needs;
    for (const auto& drone : plan.drones) {
        if (is_python_file(drone.kind))
            add(needs, drone, drone.kind, form);
        for (const auto& [name, value] : drone.set.items())
            if (value.is_string() && is_file(value.get<std::string>()))
                add(needs, drone, value.get<std::string>(), form);
    }
    std::vector<std::string> notes;
    std::ranges::transform(needs, std::back_inserter(notes), text_of);
    return notes;
}

}  // namespace hive
