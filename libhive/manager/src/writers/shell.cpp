// Writes a script of hivectl commands, as one would type them.
#include "shell.hpp"

#include "../engines/engine.hpp"
#include "command_lines.hpp"
#include "writer.hpp"

#include <hive/connection_option.hpp>

namespace hive {
namespace {

std::string line_of(const std::vector<std::string>& words)
{
    std::string text = "hivectl";
    for (const auto& word : words)
        text += " " + shell_word(word);
    return text;
}

}  // namespace

std::string start_line(const SwarmPlan& plan, const SwarmDrone& drone)
{
    std::vector<std::string> words{"start", drone.kind, "--as", drone.name};
    const auto engine = plan.engine_of(drone.host);
    if (engine.name == "slurm")
        throw Error(Errc::invalid_argument, drone.name + " is started by Slurm, which hivectl start does not do",
                    "write it as slurm, or bring it up: hivectl up");
    if (engine.name == "ssh")
        words.insert(words.end(), {"--on", engine.settings.get<std::string>()});
    return line_of(with_order(std::move(words), as_started(plan, drone)));
}

std::string connect_line(const SwarmConnection& connection)
{
    std::vector<std::string> words{"connect", to_text(connection.from), to_text(connection.to)};
    for (const auto& option : connection_option_table()) {
        if (!option.is_given(connection.options))
            continue;
        words.push_back(option.on_command_line());
        if (!option.is_flag())
            words.push_back(option.text(connection.options));
    }
    return line_of(words);
}

ExportedFiles write_shell(const SwarmPlan& plan, const ExportOptions&)
{
    std::string text = "#!/usr/bin/env bash\n# The swarm " + plan.name
                       + ": starts its drones and connects them.\nset -euo pipefail\n\n";
    for (const auto& drone : plan.drones)
        text += start_line(plan, drone) + "\n";
    for (const auto& connection : plan.connections)
        text += connect_line(connection) + "\n";
    return {{plan.name + ".sh", text, true}};
}

}  // namespace hive
