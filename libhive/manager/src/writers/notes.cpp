// Lists what drones need and no form contains (Python files, files that they read or write, devices), and what a form
// cannot carry.
#include "needs.hpp"

#include <hive/printable.hpp>
#include <hive/program.hpp>
#include <hive/swarm_export.hpp>

#include <algorithm>

namespace hive {
namespace {

bool is_device(const std::string& text) { return text.starts_with("/dev/"); }

bool in_containers(std::string_view form) { return form == "compose" || form == "kubernetes"; }

/// The same in a pod. Folders of a node are mounted; without a node, a claim is.
std::string lack_in_pod(const SwarmDrone& drone, const std::string& thing)
{
    if (is_device(thing))
        return std::string("which its privileged container gets from the node, if group 44 has access there")
               + (drone.host == Place::here ? "; name the node: \"on\"" : "");
    if (drone.host == Place::here)
        return "whose folder is a claim, empty at first, that the swarm's deletion keeps";
    return "whose folder must be on " + drone.host + ", where user 65532 needs access";
}

/// What is missing where the form runs the drone, and the remedy; empty: nothing.
std::string lack_of(const SwarmDrone& drone, const std::string& thing, std::string_view form)
{
    if (in_containers(form)) {
        if (is_device(thing) && thing.find(':') != std::string::npos)
            return "which cannot be in a container: use a path without ':'";
        if (!is_device(thing) && folder_of(thing).empty())
            return "which is not in the image: add it there, or as a volume";
        if (form == "kubernetes")
            return lack_in_pod(drone, thing);
        return is_device(thing) ? ""
                                : "whose folder is mounted: it has to be there, with access for the user of the "
                                  "container";
    }
    if (is_device(thing) || (drone.host == Place::here && (form == "shell" || thing.starts_with("/"))))
        return {};
    const std::string there = drone.host == Place::here ? "it has to be there" : "it has to be on " + drone.host;
    if (thing.starts_with("/"))
        return there;
    return there + ", seen from " + (form == "systemd" ? "the user's home directory" : "where the script is called");
}

/// Does another engine start it?
bool left_out(const SwarmPlan& plan, const SwarmDrone& drone, std::string_view form)
{
    const auto under_slurm = [&](const SwarmDrone& one) { return plan.engine_of(one.host).name == "slurm"; };
    return form == "slurm" && !under_slurm(drone) && std::ranges::any_of(plan.drones, under_slurm);
}

/// What the file says about the drone and the form does not do, one clause each.
std::vector<std::string> lost_of(const SwarmPlan& plan, const SwarmDrone& drone, std::string_view form)
{
    std::vector<std::string> lost;
    if (left_out(plan, drone, form))
        lost.push_back("left out: the engine " + plan.engine_of(drone.host).name + " starts it on "
                       + (drone.host == Place::here ? "this machine" : drone.host));
    if (form == "compose" && drone.host != Place::here)
        lost.push_back("runs on the machine of the containers, not on " + drone.host);
    if (in_containers(form) && !drone.key.empty())
        lost.emplace_back("has the key of the secret, not \"key\"");
    if (in_containers(form) && (!drone.listen.empty() || !drone.advertise.empty()))
        lost.emplace_back("listens at port 7700 for other containers only");
    if (form == "kubernetes" && drone.restart != Restart::always)
        lost.emplace_back("restarted after every exit, as with \"restart\": \"always\"");
    if (form == "shell" && drone.restart != Restart::never)
        lost.emplace_back("never restarted");
    if (form == "shell" && (drone.cpus > 0 || drone.memory_mib > 0))
        lost.emplace_back("cpus and memory_mib are not limited");
    if ((form == "shell" || form == "systemd") && drone.gpus > 0)
        lost.emplace_back("gpus are not reserved");
    return lost;
}

struct Need {
    std::string thing, lack;  ///< no thing: the lack is a clause about the drones
    std::vector<std::string> drones;
};

void add(std::vector<Need>& needs, const SwarmDrone& drone, const std::string& thing, const std::string& lack)
{
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
    const auto drones =
        need.drones.front() + (others == 0 ? std::string() : " and " + std::to_string(others) + " more");
    if (need.thing.empty())
        return printable(drones + ": " + need.lack);
    return printable(drones + (others == 0 ? " needs " : " need ") + need.thing + ", " + need.lack);
}

}  // namespace

std::vector<std::string> export_notes(const SwarmPlan& plan, std::string_view form, const ExportOptions& options)
{
    const auto needed = needs_of(plan, options.interface_of);
    std::vector<Need> needs;
    for (const auto& drone : plan.drones) {
        for (const auto& one : lost_of(plan, drone, form))
            add(needs, drone, "", one);
        if (left_out(plan, drone, form))
            continue;
        if (is_python_file(drone.kind))
            add(needs, drone, drone.kind, lack_of(drone, drone.kind, form));
        for (const auto& file : needed.at(drone.name).files)
            add(needs, drone, file, lack_of(drone, file, form));
    }
    std::vector<std::string> notes;
    std::ranges::transform(needs, std::back_inserter(notes), text_of);
    return notes;
}

}  // namespace hive
