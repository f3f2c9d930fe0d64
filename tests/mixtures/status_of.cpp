// The one place that knows how an application gives the status of a drone.
#include "status_of.hpp"

namespace hive::mixtures {
namespace {

Json edge_of(Json row)
{
    row.erase("encoding");
    return {{"receiver", row["receiver"]},
            {"connected", true},
            {"options", to_json(connection_options(row))},
            {"came", row["produced"]},
            {"acknowledged", row["delivered"]},
            {"skipped", row["skipped"]},
            {"dropped", row["dropped"]},
            {"abandoned", row["abandoned"]}};
}

/// Drones of the time before ledgers.
Json modern(Json json)
{
    for (auto& output : json["outputs"]) {
        if (!output.contains("receivers"))
            continue;
        output["edges"] = Json::array();
        for (const auto& row : output["receivers"])
            output["edges"].push_back(edge_of(row));
        output["why"] = "not_asked";
    }
    for (auto& input : json["inputs"])
        if (input.contains("state")) {
            input["connected"] = input["state"] == "connected";
            const auto done = input["processed"].get<std::int64_t>();
            input["in_hand"] = input["received"].get<std::int64_t>() - done;
            input["processed"] = done - input["abandoned"].get<std::int64_t>();
        }
    return json;
}

}  // namespace

Statuses statuses_of(Application& application, const std::vector<std::string>& drones)
{
    Statuses statuses;
    for (const auto& answer : application.status(drones))
        if (!answer.error)
            statuses.emplace(answer.drone, status_from_json(modern(answer.result)));
    return statuses;
}

}  // namespace hive::mixtures
