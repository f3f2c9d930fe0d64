// Reads the engines of a swarm file.
#include "../engines/systemd_unit.hpp"
#include "reader.hpp"
#include "words.hpp"

#include <hive/name.hpp>
#include <hive/printable.hpp>

#include <algorithm>

namespace hive::swarm_file {

void Reader::read_engine(const std::string& glob, const Value& value)
{
    const auto fits = [&](const SwarmDrone& drone) { return matches_glob(glob, drone.host); };
    if (!all_unclear_ && unclear_.empty() && std::ranges::none_of(plan_.drones, fits))
        mistakes_.at_key(value, misspelt("no drone in this file is on a host matching " + in_quotes(glob), glob,
                                         plan_.drones, &SwarmDrone::host));
    if (interface_of_)
        check_not_shadowed(glob, value);
    Members members(mistakes_, value, "an engine", engine_keys);
    if (!value.json->is_object())
        return;
    if (value.json->size() != 1)
        return mistakes_.at_value(value, "an engine is exactly one of " + listed(engine_keys));
    for (const auto& [name, place] : value.place->members) {
        const auto settings = value.member(name, place);
        if (name == "ssh") {
            const auto host = text_of(mistakes_, settings);
            if (host && !is_machine(*host))
                mistakes_.at_value(settings, in_quotes(*host) + " is not a valid ssh host",
                                   "write HOST, USER@HOST, or a name of ssh's own");
        } else if (name == "slurm") {
            read_slurm(settings);
        } else if (name == "local" || name == "systemd") {
            Members none(mistakes_, settings, "the engine " + name, {});
        }
        plan_.engines.emplace_back(glob, SwarmEngine{name, *settings.json});
    }
}

/// The first engine that matches a machine is used.
void Reader::check_not_shadowed(const std::string& glob, const Value& value)
{
    const auto has_engine = [&](const SwarmDrone& drone) {
        return std::ranges::any_of(plan_.engines,
                                   [&](const auto& engine) { return matches_glob(engine.first, drone.host); });
    };
    bool fits = false, counts = false;
    for (const auto& drone : plan_.drones)
        if (matches_glob(glob, drone.host)) {
            fits = true;
            counts = counts || !has_engine(drone);
        }
    if (fits && !counts)
        mistakes_.at_key(value, in_quotes(glob) + " counts for no drone: an engine before it fits the same machines",
                         "write the narrower one first");
}

void Reader::read_slurm(const Value& value)
{
    Members members(mistakes_, value, "the engine slurm", slurm_keys);
    if (const auto partition = members.find("partition"))
        read_directive(*partition);
    for (const std::string key : {"options", "job"})
        if (const auto list = members.find(key))
            read_slurm_options(*list, key);
}

void Reader::read_slurm_options(const Value& list, const std::string& key)
{
    if (!list.json->is_array())
        return mistakes_.at_value(list, in_quotes(key) + " must be a list of texts, not " + shown(*list.json));
    for (std::size_t i = 0; i < list.json->size(); ++i)
        read_slurm_option(list.item(i));
}

/// An option must fit on a line of a batch script.
void Reader::read_directive(const Value& value)
{
    const auto text = text_of(mistakes_, value);
    if (text && printable(*text) != *text)
        mistakes_.at_value(value, in_quotes(*text) + " has a character that does not belong into a line");
}

void Reader::read_slurm_option(const Value& value)
{
    read_directive(value);
    if (interface_of_ && value.json->is_string() && !value.json->get<std::string>().starts_with('-'))
        mistakes_.at_value(value, in_quotes(value.json->get<std::string>()) + " is not a Slurm option",
                           "options start with -, such as --gres=gpu:1");
}

void Reader::check_engines()
{
    for (const auto& entry : read_entries_) {
        auto hosts = entry.hosts;
        std::erase_if(hosts, [&](const auto& host) { return plan_.engine_of(host).name != "systemd"; });
        const auto* restart = entry.value.place->member("restart");
        if (!hosts.empty() && restart && entry.drone.restart == Restart::always)
            mistakes_.at_value(entry.value.member("restart", *restart), restart_refused(entry.name));
        std::erase(hosts, Place::here);
        if (!hosts.empty())
            mistakes_.at_value(entry.value.member("on", *entry.value.place->member("on")),
                               systemd_refused(hosts.front()));
    }
}

}  // namespace hive::swarm_file
