// Writes a script for sbatch: each drone is a step of the allocation, on the node named as its machine.
#include "../directory.hpp"
#include "../engines/engine.hpp"
#include "command_lines.hpp"
#include "writer.hpp"

#include <algorithm>
#include <map>
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
    std::map<std::string, std::vector<const SwarmDrone*>> drones;  ///< by machine
};

std::vector<std::string> options_of(const SwarmEngine& engine)
{
    std::vector<std::string> options;
    if (engine.name != "slurm")
        return options;
    if (engine.settings.contains("partition"))
        options.push_back("--partition=" + engine.settings["partition"].get<std::string>());
    for (const auto* key : {"options", "job"})
        for (const auto& option : engine.settings.value(key, Json::array()))
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
            components.push_back({options_of(plan.engine_of(drone->host)), {}, {}});
        auto& component =
            components[static_cast<std::size_t>(component_of(components, plan, *drone) - components.begin())];
        component.drones[drone->host].push_back(drone);
        if (drone->host != Place::here)
            component.nodes.insert(machine_name(drone->host));
    }
    return components;
}

bool has_gpus(const Component& component)
{
    return std::ranges::any_of(component.drones, [](const auto& machine) {
        return std::ranges::any_of(machine.second, [](const auto* drone) { return drone->gpus > 0; });
    });
}

/// Enough on each node for the drones of that node. Those without an amount of their own share one processor, and may
/// need any memory.
std::vector<std::string> amounts_of(const Component& component)
{
    int cpus = 0, gpus = 0;
    std::int64_t memory = 0;
    bool all_memory = false, any_cpus = false, any_memory = false;
    for (const auto& [host, drones] : component.drones) {
        int cpus_here = 0, gpus_here = 0;
        std::int64_t memory_here = 0;
        bool share = false;
        for (const auto* drone : drones) {
            const int own_cpus = std::max(drone->cpus, drone->gpus > 0 ? 1 : 0);  // its step is --exact
            cpus_here += own_cpus;
            memory_here += drone->memory_mib;
            gpus_here += drone->gpus;
            share = share || own_cpus == 0;
            any_cpus = any_cpus || own_cpus > 0;
            any_memory = any_memory || drone->memory_mib > 0;
            all_memory = all_memory || drone->memory_mib == 0;
        }
        cpus = std::max(cpus, cpus_here + (share ? 1 : 0));
        memory = std::max(memory, memory_here);
        gpus = std::max(gpus, gpus_here);
    }
    std::vector<std::string> options;
    if (any_cpus)
        options.insert(options.end(), {"--ntasks-per-node=1", "--cpus-per-task=" + std::to_string(cpus)});
    if (any_memory)
        options.push_back("--mem=" + (all_memory ? std::string("0") : std::to_string(memory) + "M"));
    if (gpus > 0)
        options.push_back("--gres=gpu:" + std::to_string(gpus));
    return options;
}

/// sbatch reads an option up to a space or a #, unless it is in quotes.
std::string directive(const std::string& option)
{
    if (option.find_first_of(" #\\\"'") == std::string::npos)
        return "#SBATCH " + option + "\n";
    std::string text;
    for (const char c : option)
        text += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
    return "#SBATCH \"" + text + "\"\n";
}

/// One line per option of sbatch; those of the file come last, and prevail.
std::string directives(const SwarmPlan& plan, const std::vector<Component>& components)
{
    std::string text = "#SBATCH --job-name=" + plan.name + "\n";
    for (const auto& component : components) {
        const auto& nodes = component.nodes;
        text += &component == &components.front() ? "" : "#SBATCH hetjob\n";
        for (const auto& options : {amounts_of(component), component.options})
            for (const auto& option : options)
                text += directive(option);
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
# Before the time limit, with --signal=B:TERM@60: nothing is started again, and Slurm ends the steps.
trap 'kill "${steps[@]}" 2> /dev/null; exit 143' TERM
)";

/// @param group     that of srun; empty: there is only one
/// @param has_gpus  has the component any?
std::string step(const SwarmDrone& drone, const std::string& group, bool has_gpus, const CommandLines& lines)
{
    const auto node = drone.host == Place::here ? "" : shell_word(machine_name(drone.host));
    std::string text = "HIVE_HOME=$home" + (node.empty() ? "" : "-" + node) + " keep "
                       + restart_word(drone.restart, "never") + " srun --nodes=1 --ntasks=1 --job-name=" + drone.name
                       + (group.empty() ? "" : " --het-group=" + group);
    if (!node.empty())
        text += " --nodelist=" + node;
    for (const auto& option : step_amounts(drone))
        text += " " + option;
    if (has_gpus && drone.gpus == 0)
        text += " --gres=none";  // otherwise it gets all of the job
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
        text += step(*drone, components.size() > 1 ? std::to_string(group) : "",
                     has_gpus(components[static_cast<std::size_t>(group)]), lines);
    }
    text += "\n# The job fails when one of them does.\ncode=0\nfor step in \"${steps[@]}\"; do wait \"$step\" || "
            "code=$?; done\n"
            "exit \"$code\"\n";
    return {{plan.name + ".sbatch", text, true}};
}

}  // namespace hive
