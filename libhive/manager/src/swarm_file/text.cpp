// Writes a swarm file: a line per drone, connection and engine, without default values.
#include "assembly.hpp"
#include "words.hpp"

#include <hive/connection_option.hpp>
#include <hive/swarm_plan.hpp>

namespace hive {
namespace {

/// JSON on one line with spaces, for people.
std::string spaced(const Json& value)
{
    if (value.is_string())
        return to_text(Json(swarm_file::without_variables(value.get<std::string>())));
    if (!value.is_structured() || value.empty())
        return to_text(value);
    std::string text;
    if (value.is_array())
        for (const auto& item : value)
            text += (text.empty() ? "" : ", ") + spaced(item);
    else
        for (const auto& [key, item] : value.items())
            text += (text.empty() ? "" : ", ") + to_text(Json(key)) + ": " + spaced(item);
    return value.is_array() ? "[" + text + "]" : "{" + text + "}";
}

/// An object that keeps its members in the order of insertion.
class OneLine {
public:
    OneLine& add(std::string_view key, const Json& value)
    {
        text_ += (text_.empty() ? "" : ", ") + to_text(Json(key)) + ": " + spaced(value);
        return *this;
    }
    OneLine& add_unless(const Json& usual, std::string_view key, const Json& value)
    {
        return value == usual ? *this : add(key, value);
    }
    [[nodiscard]] std::string text() const { return "{" + text_ + "}"; }

private:
    std::string text_;
};

std::string text_of_drone(const SwarmDrone& drone)
{
    OneLine line;
    line.add("kind", drone.kind).add_unless(Place::here, "on", drone.host).add_unless(Json::object(), "set", drone.set);
    for (const auto& field : order_fields())
        if (field.type != OrderField::Type::kind)
            line.add_unless(field.value({}), field.name, field.value(drone));
    return line.text();
}

std::string text_of_connection(const SwarmConnection& connection, const Json& to)
{
    OneLine line;
    line.add("from", to_text(connection.from)).add("to", to);
    for (const auto& option : connection_option_table())
        if (option.name == "group" && connection.options.group == connection.from.drone)
            line.add("share", true);
        else
            line.add_unless(option.value({}), option.name, option.value(connection.options));
    return line.text();
}

/// Consecutive connections that differ only in the receiver are written as one.
std::vector<std::string> texts_of_connections(const std::vector<SwarmConnection>& connections)
{
    std::vector<std::string> lines;
    for (auto first = connections.begin(); first != connections.end();) {
        auto receivers = Json::array();
        auto next = first;
        const auto like_first = [&] { return SwarmConnection{next->from, first->to, next->options} == *first; };
        for (; next != connections.end() && like_first(); ++next)
            receivers.push_back(to_text(next->to));
        lines.push_back(text_of_connection(*first, receivers.size() == 1 ? receivers[0] : receivers));
        first = next;
    }
    return lines;
}

/// The lines between two brackets; an empty section is omitted.
std::string section(std::string_view name, std::string_view brackets, const std::vector<std::string>& lines)
{
    if (lines.empty())
        return {};
    std::string text = ",\n  " + to_text(Json(name)) + ": " + brackets[0];
    for (std::size_t i = 0; i < lines.size(); ++i)
        text += (i == 0 ? "\n    " : ",\n    ") + lines[i];
    return text + "\n  " + brackets[1];
}

}  // namespace

std::string to_text(const SwarmPlan& plan)
{
    std::vector<std::string> drones, engines;
    for (const auto& drone : plan.drones)
        drones.push_back(to_text(Json(drone.name)) + ": " + text_of_drone(drone));
    for (const auto& [glob, engine] : plan.engines)
        engines.push_back(to_text(Json(glob)) + ": " + OneLine().add(engine.name, engine.settings).text());
    return "{\n  \"swarm\": " + to_text(Json(plan.name))
           + (drones.empty() ? ",\n  \"drones\": {}" : section("drones", "{}", drones))
           + section("connections", "[]", texts_of_connections(plan.connections)) + section("engines", "{}", engines)
           + "\n}\n";
}

}  // namespace hive
