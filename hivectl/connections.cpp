// Joining the senders' lists of receivers with the receivers' lists of inputs.
#include "connections.hpp"

#include "format.hpp"

#include <map>

namespace hivectl {
namespace {

using Ends = std::pair<std::string, std::string>;  // from, to

/// What each end says of one connection; null when it says nothing.
struct BothEnds {
    const hive::Json* at_sender = nullptr;
    const hive::Json* at_receiver = nullptr;
};

std::map<Ends, BothEnds> joined(const std::vector<hive::Answer>& statuses)
{
    std::map<Ends, BothEnds> connections;
    for (const auto& answer : statuses) {
        for (const auto& output : list_in(answer.result, "outputs"))
            for (const auto& receiver : list_in(output, "receivers"))
                connections[{answer.drone + "." + text_in(output, "name"), text_in(receiver, "receiver")}].at_sender =
                    &receiver;
        for (const auto& input : list_in(answer.result, "inputs"))
            if (const auto from = text_in(input, "from"); !from.empty())
                connections[{from, answer.drone + "." + text_in(input, "input")}].at_receiver = &input;
    }
    return connections;
}

hive::Json field(const hive::Json* object, const char* key)
{
    return object && object->is_object() && object->contains(key) ? (*object)[key] : hive::Json();
}

std::string state_of(const BothEnds& ends)
{
    if (ends.at_receiver)
        return text_in(*ends.at_receiver, "state");
    return "connected";
}

/// How the bodies travel: through shared memory, or through the socket; null as long as none did.
hive::Json way_of(const hive::Json* at_sender)
{
    const auto count = [&](const char* key) {
        const auto value = field(at_sender, key);
        return value.is_number() ? value.get<std::int64_t>() : 0;
    };
    const auto shared = count("shared"), fallback = count("fallback");
    if (shared == 0)
        return count("delivered") > 0 ? hive::Json("socket") : hive::Json();
    return fallback == 0 ? "memory" : "memory, " + std::to_string(fallback) + " by socket";
}

Row row_of(const Ends& names, const BothEnds& ends)
{
    Row row{{"from", names.first}, {"to", names.second}};
    for (const char* key : {"transfer", "delivery", "window", "group", "encoding"})
        row.add(key, field(ends.at_sender ? ends.at_sender : ends.at_receiver, key));
    row.add("way", way_of(ends.at_sender));
    row.add("state", state_of(ends));
    row.add("known_by", !ends.at_receiver ? "sender" : !ends.at_sender ? "receiver" : "both");
    for (const char* key :
         {"produced", "delivered", "skipped", "dropped", "abandoned", "in_flight", "shared", "fallback"})
        row.add(key, field(ends.at_sender, key));
    row.add("age_us", field(ends.at_receiver, "last_age_us"));
    row.add("error", field(ends.at_receiver, "error"));
    return row;
}

}  // namespace

std::vector<Row> connection_rows(const std::vector<hive::Answer>& statuses)
{
    std::vector<Row> rows;
    for (const auto& [names, ends] : joined(statuses))
        rows.push_back(row_of(names, ends));
    return rows;
}

}  // namespace hivectl
