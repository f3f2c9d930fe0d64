// Writes a script for sbatch: each drone is a step of the allocation, on the node named as its machine.
#include "command_lines.hpp"
#include "writer.hpp"

#include <algorithm>
#include <set>

namespace hive {
namespace {

/// The steps are the drones of machines with the engine slurm; all drones if there are none.
std::vector<const SwarmDrone*> steps_of(const SwarmPlan& plan)
{
    std::vector<const SwarmDrone*> all, by_slurm;
    for (const auto& drone : plan.drones) {
        all.push_back(&drone);
        if (plan.engine_of(drone.host).name == "slurm")
            by_slurm.push_back(&drone);
    }
    return by_slurm.empty() ? all : by_slurm;
}

std::string joined(const std::set<std::string>& names)
{
    std::string text;
    for (const auto& name : names)
        text += (text.empty() ? "" : ",") + name;
    return text;
}

/// Nodes that are requested with the same options. Several groups make a heterogeneous job: sbatch applies the options
/// of a component to its nodes alone.
struct Component {
    std::vector<std::string> options;
    std::set<std::string> nodes;
};

std::vector<std::string> options_of(const SwarmEngine& engine)
{
    std::vector<std::string> options;
    if (engine.name != "slurm")
        return options;
    if (engine.settings.contains("partition"))
        options.push_back("--partition=" + engine.settings["partition"].get<std::string>());
    for (const auto& option : engine.settings.value("options", Json::array()))
        options.push_back(option.get<std::string>());
    return options;
}

auto component_of(const std::vector<Component>& components, const SwarmPlan& plan, const SwarmDrone& drone)
{
    return std::ranges::find(components, options_of(plan.engine_of(drone.host)), &Component::options);
}

std::vector<Component> components_of(const SwarmPlan& plan, const std::vector<const SwarmDrone*>& steps)
{
    std::vector<Component> components;
    for (const auto* drone : steps) {
        if (component_of(components, plan, *drone) == components.end())
            components.push_back({options_of(plan.engine_of(drone->host)), {}});
        if (drone->host != Place::here)
            components[static_cast<std::size_t>(component_of(components, plan, *drone) - components.begin())]
                .nodes.insert(machine_name(drone->host));
    }
    return components;
}

/// One line per option of sbatch.
std::string directives(const SwarmPlan& plan, const std::vector<Component>& components)
{
    std::string text = "#SBATCH --job-name=" + plan.name + "\n";
    for (const auto& [options, nodes] : components) {
        text += &options == &components.front().options ? "" : "#SBATCH hetjob\n";
        for (const auto& option : options)
            text += "#SBATCH " + option + "\n";
        text += "#SBATCH --nodes=" + std::to_string(std::max<std::size_t>(nodes.size(), 1)) + "\n";
        text += nodes.empty() ? "" : "#SBATCH --nodelist=" + joined(nodes) + "\n";
    }
    return text;
}

constexpr auto functions = R"(set -u

# Each node has a home of its own: in one that nodes share, the sockets of another node mean nothing.
home=${HIVE_HOME:-/tmp/hive-$UID-$SLURM_JOB_ID}

# keep never|on-failure|always COMMAND...: runs it, and again as the swarm says, at most 5 times within 60 s.
keep() {
    local when=$1 code times=()
    shift
    while :; do
        "$@"
        code=$?
        [ "$when" = always ] || { [ "$when" = on-failure ] && [ "$code" -ne 0 ]; } || return "$code"
        times+=("$SECONDS")
        [ "${#times[@]}" -lt 5 ] || [ $((SECONDS - times[-5])) -ge 60 ] || return "$code"
        sleep 1
    done
}

steps=()
)";

/// @param group  that of srun; empty: there is only one
std::string step(const SwarmDrone& drone, const std::string& group, const CommandLines& lines)
{
    constexpr std::array words{"never", "on-failure", "always"};
    const auto node = drone.host == Place::here ? "" : shell_word(machine_name(drone.host));
    std::string text = "HIVE_HOME=$home" + (node.empty() ? "" : "-" + node) + " keep "
                       + words.at(static_cast<std::size_t>(drone.restart))
                       + " srun --nodes=1 --ntasks=1 --overlap --job-name=" + drone.name
                       + (group.empty() ? "" : " --het-group=" + group);
    if (!node.empty())
        text += " --nodelist=" + node;
    for (const auto& word : lines.of(drone))
        text += " " + shell_word(word);
    return text + " &\nsteps+=($!)\n";
}

}  // namespace

ExportedFiles write_slurm(const SwarmPlan& plan, const ExportOptions&)
{
    const auto steps = steps_of(plan);
    const CommandLines lines(plan, CommandLines::Machines::as_planned);
    const auto components = components_of(plan, steps);
    std::string text = "#!/usr/bin/env bash\n" + directives(plan, components) + "# The swarm " + plan.name
                       + ". Start it: sbatch " + plan.name + ".sbatch    end it: scancel --name=" + plan.name + "\n"
                       + functions;
    for (const auto* drone : steps) {
        const auto group = component_of(components, plan, *drone) - components.begin();
        text += step(*drone, components.size() > 1 ? std::to_string(group) : "", lines);
    }
    text += "\n# The job fails when one of them does.\ncode=0\nfor step in \"${steps[@]}\"; do wait \"$step\" || "
            "code=$?; done\n"
            "exit \"$code\"\n";
    return {{plan.name + ".sbatch", text, true}};
}

}  // namespace hive
