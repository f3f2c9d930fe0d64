// Reads the drones of a swarm file.
#include "../directory.hpp"
#include "reader.hpp"
#include "words.hpp"

#include <hive/name.hpp>
#include <hive/program.hpp>

#include <algorithm>

namespace hive::swarm_file {

bool is_machine(std::string_view text)
{
    const auto host = machine_name(std::string(text));  // the host becomes the name of a folder
    return !text.empty() && text.size() <= 255 && text.front() != '-' && !host.empty() && !host.starts_with('.')
           && std::ranges::all_of(text, [](unsigned char c) { return c > ' ' && c < 0x7F; })
           && text.find_first_of("'\"`$;&|<>()\\/*?") == std::string_view::npos;
}

std::span<const std::string_view> drone_keys()
{
    static const auto keys = [] {
        std::vector all{"count"sv, "on"sv, "set"sv};
        std::ranges::transform(order_fields(), std::back_inserter(all), &OrderField::name);
        return all;
    }();
    return keys;
}

void Reader::read_drones(const Value& drones)
{
    if (!require_object(mistakes_, drones)) {
        all_unclear_ = true;
        return;
    }
    for (const auto& [name, place] : drones.place->members)
        if (const auto entry = read_drone(name, drones.member(name, place))) {
            expand(*entry);
            read_entries_.push_back(*entry);
        } else {
            unclear_.insert(name);
        }
}

std::optional<Reader::Entry> Reader::read_drone(const std::string& name, const Value& value)
{
    Entry entry{.name = name, .value = value};
    try {
        require_name(name, "drone");
    } catch (const Error& error) {
        mistakes_.at_key(value, error);
        return std::nullopt;
    }
    Members members(mistakes_, value, "a drone", drone_keys());
    if (!value.json->is_object())
        return std::nullopt;
    entry.count = members.integer("count", 1, most_of_a_kind);
    read_kind(members, entry);
    read_hosts(members, entry);
    read_options(members, entry);
    read_addresses(members, entry);
    if (const auto settings = members.find("set"))
        read_settings(*settings, entry);
    return members.find("count") && !entry.count ? std::nullopt : std::optional(std::move(entry));
}

void Reader::read_kind(Members& members, Entry& entry)
{
    const auto value = members.require("kind");
    const auto kind = value ? text_of(mistakes_, *value) : std::nullopt;
    if (!kind)
        return;
    try {
        entry.drone.kind = is_python_file(*kind) ? *kind : require_name(*kind, "kind");
    } catch (const Error& error) {
        mistakes_.at_value(*value, error);
    }
}

void Reader::read_hosts(Members& members, Entry& entry)
{
    entry.hosts = {Place::here};
    const auto value = members.find("on");
    if (!value)
        return;
    const auto texts = texts_of(mistakes_, *value);
    for (const auto& [text, place] : texts)
        if (!is_machine(text))
            mistakes_.at_value(place, in_quotes(text) + " is not a valid ssh host", "write HOST or USER@HOST");
    if (texts.size() > 1 && !members.find("count"))
        mistakes_.at_value(*value, "one drone cannot be on " + std::to_string(texts.size()) + " machines",
                           "say how many there are to be: \"count\": " + std::to_string(texts.size()));
    if (!texts.empty())
        entry.hosts.clear();
    for (const auto& text : texts)
        entry.hosts.push_back(text.first);
}

void Reader::read_options(Members& members, Entry& entry)
{
    using enum OrderField::Type;
    for (const auto& field : order_fields())
        if (field.type == flag)
            field.set(entry.drone, members.flag(field.name));
        else if (field.type == word)
            field.set(entry.drone, members.word(field.name, field.words).value_or(""));
        else if (field.type == file)
            field.set(entry.drone, members.text(field.name).value_or(""));
        else if (field.type == amount)
            field.set(entry.drone, members.integer(field.name, 1, field.most).value_or(0));
}

void Reader::read_settings(const Value& settings, Entry& entry)
{
    if (!require_object(mistakes_, settings))
        return;
    for (const auto& [name, place] : settings.place->members) {
        const auto setting = settings.member(name, place);
        entry.drone.set[name] = *setting.json;
        check_setting(setting, name, entry);
    }
}

void Reader::check_setting(const Value& setting, const std::string& name, const Entry& entry)
{
    if (!is_name(name))
        return mistakes_.at_key(setting, in_quotes(name) + " is not the name of a parameter");
    if (setting.json->is_structured() || setting.json->is_null())
        return mistakes_.at_value(setting, in_quotes(name) + " must be a number, string or boolean, not "
                                               + shown(*setting.json));
    const auto* interface = this->interface(entry.drone.kind);
    if (!interface)
        return;
    const auto* parameter = interface->parameter(name);
    if (!parameter) {
        return mistakes_.at_key(
            setting, misspelt("a drone of the kind " + entry.drone.kind + " has no parameter " + in_quotes(name), name,
                              interface->parameters, &ParameterInfo::name,
                              "see them: hive-" + entry.drone.kind + " --describe"));
    }
    try {
        checked_value(*parameter, *setting.json);
    } catch (const Error& error) {
        mistakes_.at_value(setting, error);
    }
}

void Reader::expand(const Entry& entry)
{
    if (entry.count)
        counted_.insert(entry.name);
    bool own_ports = true;
    for (std::int64_t i = 0; i < entry.count.value_or(1); ++i) {
        auto drone = entry.drone;
        drone.name = entry.count ? entry.name + "-" + std::to_string(i + 1) : entry.name;
        drone.host = entry.hosts[static_cast<std::size_t>(i) % entry.hosts.size()];
        if (!is_name(drone.name))
            return mistakes_.at_key(entry.value, in_quotes(drone.name) + " is too long for a name");
        if (drone.name == lock_of(plan_.name))
            return mistakes_.at_key(entry.value, in_quotes(drone.name) + " is what the swarm itself is locked by",
                                    "call the drone something else");
        const auto [same, is_new] = entries_.try_emplace(drone.name, entry.value.path);
        if (!is_new) {
            mistakes_.at_key(entry.value, "two drones are called " + drone.name,
                             "the other one comes from " + same->second);
            continue;
        }
        own_ports = own_ports && has_own_port(drone, entry);  // report it once
        places_[drone.name] = plan_.drones.size();
        plan_.drones.push_back(std::move(drone));
    }
}

}  // namespace hive::swarm_file
