// Reads a swarm file from top to bottom.
#include "assembly.hpp"
#include "reader.hpp"
#include "words.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hive {
namespace swarm_file {
void Reader::read(const Value& file, bool complete)
{
    all_unclear_ = !complete;
    Members members(mistakes_, file, "a swarm file", file_keys);
    if (const auto value = members.require("swarm"))
        if (const auto name = text_of(mistakes_, *value)) {
            plan_.name = *name;
            if (!is_name(lock_of(*name)) || !is_name(*name))
                mistakes_.at_value(*value, in_quotes(*name) + " is not a name for a swarm",
                                   "use 1 to 58 letters, digits, '_', '.' or '-', starting with a letter or digit");
        }
    members.text("$schema");
    if (const auto drones = members.require("drones"))
        read_drones(*drones);
    if (const auto list = members.find("connections")) {
        if (!list->json->is_array())
            mistakes_.at_value(*list, "\"connections\" must be a list, not " + shown(*list->json));
        else
            for (std::size_t i = 0; i < list->json->size(); ++i)
                read_connection(list->item(i));
    }
    if (const auto engines = members.find("engines"); engines && require_object(mistakes_, *engines))
        for (const auto& [glob, place] : engines->place->members)
            read_engine(glob, engines->member(glob, place));
    check_free_ports();
    if (interface_of_) {
        check_engines();
        tell_unknown_kinds();
    }
}

SwarmReading Reader::take() { return {std::move(plan_), mistakes_.take(), notes_.take()}; }

const Interface* Reader::interface(const std::string& kind)
{
    if (!interface_of_ || kind.empty())
        return nullptr;
    auto found = interfaces_.find(kind);
    if (found == interfaces_.end())
        try {
            found = interfaces_.emplace(kind, interface_of_(kind)).first;
        } catch (const Error& error) {
            found = interfaces_.emplace(kind, error).first;
        }
    return std::get_if<Interface>(&found->second);
}

bool Reader::starts_elsewhere(const Entry& entry) const
{
    return std::ranges::any_of(entry.hosts, [&](const std::string& host) {
        const auto engine = plan_.engine_of(host).name;
        return engine == "ssh" || engine == "slurm";
    });
}

bool Reader::starts_here(const Entry& entry) const
{
    return std::ranges::any_of(entry.hosts, [&](const std::string& host) {
        const auto engine = plan_.engine_of(host).name;
        return engine == "local" || (engine == "systemd" && host == Place::here);
    });
}

void Reader::tell_unknown_kinds()
{
    std::set<std::string> noted;
    for (const auto& entry : read_entries_) {
        const auto& kind = entry.drone.kind;
        if (kind.empty() || interface(kind))
            continue;
        const auto& error = std::get<Error>(interfaces_.at(kind));
        const auto value = entry.value.member("kind", *entry.value.place->member("kind"));
        if (starts_here(entry))
            mistakes_.at_value(value, error);
        else if (noted.insert(kind).second)
            notes_.at_value(value, "parameters and ports of " + kind + " are not checked: " + error.what());
    }
}

}  // namespace swarm_file

SwarmReading read_swarm(std::string_view text, const InterfaceOfKind& interface_of, const SwarmContext& context)
{
    swarm_file::Texts texts;
    swarm_file::Reader reader(texts, interface_of);
    if (const auto file = swarm_file::assemble(text, context, texts, reader.mistakes())) {
        reader.read({&file->json.value, &file->json.place, ""}, file->complete);
        if (context.to_be_started) {
            reader.check_keys();
            reader.check_own_addresses();
        }
    }
    return reader.take();
}

}  // namespace hive
