// The export forms by name.
#include "writer.hpp"

#include "../swarm_file/words.hpp"

#include <hive/name.hpp>
#include <hive/printable.hpp>
#include <hive/program.hpp>

#include <algorithm>

namespace hive {

namespace {

/// Inserts after the first line, which is a comment or the interpreter of a script.
void add_to_head(std::string& text, const std::vector<std::string>& notes)
{
    std::string lines;
    for (const auto& note : notes)
        lines += "# " + note + ".\n";
    text.insert(text.find('\n') + 1, lines);
}

/// A program may have made the plan: nothing of it may become a line of its own in a file.
void require_lines(const SwarmPlan& plan)
{
    require_name(plan.name, "swarm");
    for (const auto& drone : plan.drones) {
        require_name(drone.name, "drone");
        if (!is_python_file(drone.kind))
            require_name(drone.kind, "kind");
        if (!swarm_file::is_machine(drone.host))
            throw Error(Errc::invalid_argument, in_quotes(drone.host) + " is not a valid machine");
    }
    for (const auto& row : plan.engines)
        for (const auto& setting : row.second.settings.flatten())
            if (setting.is_string() && printable(setting.get<std::string>()) != setting.get<std::string>())
                throw Error(Errc::invalid_argument,
                            in_quotes(setting.get<std::string>()) + " contains a control character");
}

}  // namespace

const std::vector<std::string>& export_forms()
{
    static const std::vector<std::string> forms{"systemd", "compose", "kubernetes", "slurm", "shell"};
    return forms;
}

ExportedFiles export_swarm(const SwarmPlan& plan, std::string_view form, const ExportOptions& options)
{
    constexpr std::array writers{write_systemd, write_compose, write_kubernetes, write_slurm, write_shell};
    const auto found = std::ranges::find(export_forms(), form);
    if (options.metrics && form != "compose" && form != "kubernetes")
        throw Error(Errc::invalid_argument, "only a swarm of containers is written with its metrics",
                    "start them with the user's units: systemctl --user enable --now hive-metrics");
    if (found != export_forms().end()) {
        require_lines(plan);
        auto files = writers.at(static_cast<std::size_t>(found - export_forms().begin()))(plan, options);
        if (!files.empty())
            add_to_head(files.front().text, export_notes(plan, form, options));
        return files;
    }
    std::string list;
    for (const auto& one : export_forms())
        list += (list.empty() ? "" : ", ") + one;
    throw Error(Errc::invalid_argument, "unknown export form " + in_quotes(form), "forms: " + list);
}

}  // namespace hive
