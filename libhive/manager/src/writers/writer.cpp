// The export forms by name.
#include "writer.hpp"

#include <hive/name.hpp>

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
        auto files = writers.at(static_cast<std::size_t>(found - export_forms().begin()))(plan, options);
        if (!files.empty())
            add_to_head(files.front().text, export_notes(plan, form));
        return files;
    }
    std::string list;
    for (const auto& one : export_forms())
        list += (list.empty() ? "" : ", ") + one;
    throw Error(Errc::invalid_argument, "unknown export form " + in_quotes(form), "forms: " + list);
}

}  // namespace hive
