// Reading a swarm file from top to bottom.
#include "reader.hpp"
#include "words.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hive {
namespace swarm_file {
namespace {

constexpr JsonLimits limits{.bytes = 16 << 20, .depth = 16, .keys = 20'000, .values = 1 << 20};

/// What people write who take JSON for something else.
std::pair<std::string, std::string> syntax_mistake(std::string_view text, const JsonMistake& mistake)
{
    const auto rest = text.substr(mistake.at());
    if (rest.starts_with("//") || rest.starts_with("/*") || rest.starts_with("#"))
        return {"JSON has no comments", "leave it out"};
    if (rest.empty())
        return {"the file ends too early", "see that every { and [ is closed"};
    if (rest.front() == '\'')
        return {"in JSON, texts stand in \"double\" quotation marks", ""};
    const auto before = text.substr(0, mistake.at()).find_last_not_of(" \t\r\n");
    if ((rest.front() == '}' || rest.front() == ']') && before != std::string_view::npos && text[before] == ',')
        return {"a comma before " + std::string(1, rest.front()), "there is none behind the last one of a list"};
    return {mistake.what(), mistake.advice()};
}

}  // namespace

void Reader::read(const Value& file)
{
    Members members(mistakes_, file, "a swarm file", file_keys);
    if (const auto value = members.require("swarm"))
        if (const auto name = text_of(mistakes_, *value)) {
            plan_.name = *name;
            if (!is_name(lock_of(*name)) || !is_name(*name))
                mistakes_.at_value(*value, in_quotes(*name) + " is not a name for a swarm",
                                   "use 1 to 58 letters, digits, '_', '.' or '-', and begin with a letter or digit");
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
    tell_unknown_kinds();
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

void Reader::tell_unknown_kinds()
{
    const auto is_here_started = [&](const std::string& host) {
        const auto engine = plan_.engine_of(host).name;
        return engine == "local" || (engine == "systemd" && host == Place::here);
    };
    std::set<std::string> noted;
    for (const auto& entry : read_entries_) {
        const auto& kind = entry.drone.kind;
        if (!interface_of_ || kind.empty() || interface(kind))
            continue;
        const auto& error = std::get<Error>(interfaces_.at(kind));
        const auto value = entry.value.member("kind", *entry.value.place->member("kind"));
        if (std::ranges::any_of(entry.hosts, is_here_started))
            mistakes_.at_value(value, error);
        else if (noted.insert(kind).second)
            notes_.at_value(value, "parameters and ports of " + kind + " are not checked: " + error.what());
    }
}

}  // namespace swarm_file

SwarmReading read_swarm(std::string_view text, const InterfaceOfKind& interface_of)
try {
    const auto parsed = parse_placed_json(text, swarm_file::limits);
    swarm_file::Reader reader(text, interface_of);
    reader.read({&parsed.value, &parsed.place, ""});
    return reader.take();
} catch (const JsonMistake& mistake) {
    const auto [line, column] = TextLines(text).at(mistake.at());
    const auto [what, advice] = swarm_file::syntax_mistake(text, mistake);
    return {{}, {{line, column, "", what, advice}}, {}};
}

}  // namespace hive
