#include "swarm_file.hpp"

#include <nlohmann/json.hpp>

namespace hive::mixtures {
namespace {

Json value_of(const std::string& text)
{
    auto value = Json::parse(text, nullptr, false);
    return value.is_discarded() ? Json(text) : value;
}

Json connection_of(const Edge& edge)
{
    const auto& options = edge.options;
    Json connection{{"from", edge.sender + "." + Topology::output_of(edge.sender)},
                    {"to", edge.receiver + "." + Topology::input_of(edge.receiver)}};
    if (options.delivery == Delivery::notification)
        connection["notify"] = true;
    if (options.transfer == Transfer::streaming)
        connection["stream"] = true;
    else
        connection["window"] = options.window;
    if (!options.group.empty())
        connection["group"] = options.group;
    if (options.lease)
        connection["lease"] = std::chrono::duration<double>(*options.lease).count();
    return connection;
}

}  // namespace

std::string swarm_file(const Topology& topology, const std::function<FileDrone(const std::string& drone)>& describe)
{
    Json file{{"swarm", swarm_name}, {"drones", Json::object()}, {"connections", Json::array()}};
    for (const auto& name : topology.drones()) {
        const auto [kind, settings, halted] = describe(name);
        auto& drone = file["drones"][name] = {{"kind", kind}, {"set", Json::object()}, {"halted", halted}};
        for (const auto& setting : settings) {
            const auto at = setting.find('=');
            drone["set"][setting.substr(0, at)] = value_of(setting.substr(at + 1));
        }
    }
    for (const auto& edge : topology.edges())
        file["connections"].push_back(connection_of(edge));
    return file.dump(1);
}

}  // namespace hive::mixtures
