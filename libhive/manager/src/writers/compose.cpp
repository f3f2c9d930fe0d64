// A compose file: a container for each drone, on one machine.
#include "../engines/engine.hpp"
#include "command_lines.hpp"
#include "needs.hpp"
#include "writer.hpp"
#include "yaml.hpp"

namespace hive {
namespace {

/// In compose, '$' starts a variable.
std::string compose_word(const std::string& word) { return doubled(word, '$'); }

OrderedJson container_of(const std::vector<std::string>& words, Restart restart, bool key, const ExportOptions& options)
{
    OrderedJson service{{"image", options.image}, {"command", OrderedJson::array()}};
    for (const auto& word : words)
        service["command"].push_back(compose_word(word));
    service["restart"] = restart_word(restart);
    if (key) {
        service["user"] = "${HIVE_UID:-0}:${HIVE_GID:-0}";
        service["environment"] = {{"HIVE_KEY", "/run/secrets/hive-key"}};
        service["secrets"] = {"hive-key"};
    }
    return service;
}

OrderedJson compose_service(const SwarmDrone& drone, const Needs& needs, const CommandLines& lines,
                            const ExportOptions& options)
{
    auto service = container_of(lines.of(drone), drone.restart, !drone.insecure, options);
    for (const auto& device : needs.devices)
        service["devices"].push_back(compose_word(device + ":" + device));
    if (service.contains("devices"))
        service["group_add"] = {"video"};
    for (const auto& folder : needs.folders)
        service["volumes"].push_back(
            {{"type", "bind"}, {"source", compose_word(folder)}, {"target", compose_word(folder)}});
    if (drone.cpus > 0)
        service["cpus"] = drone.cpus;
    if (drone.memory_mib > 0)
        service["mem_limit"] = std::to_string(drone.memory_mib) + "m";
    if (drone.gpus > 0)
        service["deploy"]["resources"]["reservations"]["devices"] = {
            {{"driver", "nvidia"}, {"count", drone.gpus}, {"capabilities", {"gpu"}}}};
    service["healthcheck"] = {{"test", {"CMD", "hivectl", "wait", drone.name, "--timeout", "5"}},
                              {"interval", "10s"},
                              {"timeout", "6s"},
                              {"start_period", "20s"}};
    return service;
}

}  // namespace

ExportedFiles write_compose(const SwarmPlan& plan, const ExportOptions& options)
{
    const CommandLines lines(plan, CommandLines::Machines::one_each);
    const auto needs = needs_of(plan, options.interface_of);
    OrderedJson file{{"services", OrderedJson::object()}};
    for (const auto& drone : plan.drones)
        file["services"][drone.name] = compose_service(drone, needs.at(drone.name), lines, options);
    const bool key = lines.with_key();
    if (options.metrics)
        file["services"][CommandLines::metrics_name] = container_of(lines.metrics(), Restart::always, key, options);
    std::string head = "# The swarm " + plan.name + ", a container for each drone. Start it:\n";
    if (key) {
        file["secrets"] = {{"hive-key", {{"file", "./swarm.key"}}}};
        head += "#   cp ~/.config/hive/swarm.key .\n"
                "#   HIVE_UID=$(id -u) HIVE_GID=$(id -g) docker-compose -p "
                + label_of(plan.name) + " up -d   # the key belongs to its reader\n";
    } else {
        head += "#   docker-compose -p " + label_of(plan.name) + " up -d\n";
    }
    return {{"compose.yaml", head + yaml_text(file)}};
}

}  // namespace hive
