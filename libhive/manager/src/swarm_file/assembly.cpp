// Parses each file with its comments blanked out, which keeps positions; then merges the trees.
#include "assembly.hpp"

#include "words.hpp"

#include <hive/name.hpp>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace hive::swarm_file {
namespace {

namespace fs = std::filesystem;

constexpr JsonLimits limits{.bytes = 16 << 20, .depth = 16, .keys = 20'000, .values = 1 << 20};
constexpr std::size_t most_files = 64;

/// Replaces comments with blanks.
std::string without_comments(std::string text)
{
    bool in_quotes = false;
    for (std::size_t i = 0; i < text.size(); ++i)
        if (in_quotes && text[i] == '\\')
            ++i;
        else if (text[i] == '"')
            in_quotes = !in_quotes;
        else if (!in_quotes && text.compare(i, 2, "//") == 0)
            for (; i < text.size() && text[i] != '\n'; ++i)
                text[i] = ' ';
    return text;
}

/// Explains common errors, such as comments of other languages.
std::pair<std::string, std::string> syntax_mistake(std::string_view text, const JsonMistake& mistake)
{
    const auto rest = text.substr(mistake.at());
    if (rest.starts_with("/*") || rest.starts_with("#"))
        return {"comments start with // and end with the line", ""};
    if (rest.empty())
        return {"unexpected end of file", "close every { and ["};
    if (rest.front() == '\'')
        return {"JSON strings take \"double\" quotes", ""};
    const auto before = text.substr(0, mistake.at()).find_last_not_of(" \t\r\n");
    if ((rest.front() == '}' || rest.front() == ']') && before != std::string_view::npos && text[before] == ',')
        return {"a comma before " + std::string(1, rest.front()), "there is none behind the last one of a list"};
    return {mistake.what(), mistake.advice()};
}

void shift(JsonPlace& place, std::size_t by)
{
    place.key += by;
    place.value += by;
    for (auto& member : place.members)
        shift(member.second, by);
    for (auto& item : place.items)
        shift(item, by);
}

JsonPlace* place_of(JsonPlace& object, std::string_view name)
{
    const auto found = std::ranges::find(object.members, name, &std::pair<std::string, JsonPlace>::first);
    return found == object.members.end() ? nullptr : &found->second;
}

/// Adds the members that only the second object has.
/// @param depth  depth to which common objects are merged
void add_missing(Json& json, JsonPlace& place, const Json& more, const JsonPlace& more_place, int depth)
{
    for (const auto& [key, from] : more_place.members)
        if (auto* const there = place_of(place, key); !there) {
            json[key] = more.at(key);
            place.members.emplace_back(key, from);
        } else if (depth > 0 && json.at(key).is_object() && more.at(key).is_object()) {
            add_missing(json.at(key), *there, more.at(key), from, depth - 1);
        }
}

/// Parses a value of a command line: a number or a flag, unless the variable is a text.
Json given_value(const std::string& text, const Json& usual)
{
    if (usual.is_string())
        return text;
    try {
        auto value = parse_json(text);
        return value.is_number() || value.is_boolean() ? value : Json(text);
    } catch (const Error&) {
        return text;
    }
}

class Assembly {
public:
    Assembly(const SwarmContext& context, Texts& texts, Mistakes& mistakes)
        : context_(context), texts_(texts), mistakes_(mistakes)
    {
    }

    std::optional<Assembled> run(std::string_view text)
    {
        auto file = read(std::string(text), "", context_.folder);
        if (!file)
            return std::nullopt;
        if (file->value.is_object()) {
            resolve_variables(*file);
            apply_defaults(*file, text.size());
        }
        return Assembled{*std::move(file), complete_};
    }

private:
    /// Loads a file with all its includes.
    std::optional<PlacedJson> read(std::string text, const std::string& name, const std::optional<fs::path>& folder)
    {
        const auto begin = texts_.add(name, text);
        text = without_comments(std::move(text));
        try {
            auto file = parse_placed_json(text, limits);
            shift(file.place, begin);
            include(file, folder);
            return file;
        } catch (const JsonMistake& mistake) {
            const auto [what, advice] = syntax_mistake(text, mistake);
            mistakes_.at_byte(begin + mistake.at(), "", what, advice);
            return std::nullopt;
        }
    }

    void include(PlacedJson& file, const std::optional<fs::path>& folder)
    {
        const auto* place = file.value.is_object() ? file.place.member("include") : nullptr;
        if (!place)
            return;
        const Value list = Value{&file.value, &file.place, ""}.member("include", *place);
        std::vector<PlacedJson> files;
        for (const auto& [name, value] : texts_of(mistakes_, list))
            if (auto one = read_included(name, value, folder))
                files.push_back(*std::move(one));
            else
                complete_ = false;
        for (const auto& one : files)
            add(file, one);
    }

    std::optional<PlacedJson> read_included(const std::string& name, const Value& value,
                                            const std::optional<fs::path>& folder)
    {
        const auto path = folder ? (*folder / name).lexically_normal() : fs::path(name);
        const auto refuse = [&](const std::string& why, const std::string& advice = {}) {
            mistakes_.at_value(value, path.string() + " " + why, advice);
            return std::nullopt;
        };
        std::error_code ignored;
        if (!folder)
            return refuse("is not included: where this file is, is not known");
        if (std::ranges::find(open_, path) != open_.end())
            return refuse("includes itself");
        if (++files_ > most_files)
            return refuse("is one file too many: " + std::to_string(most_files) + " may be included");
        if (!fs::is_regular_file(path, ignored) || fs::file_size(path, ignored) > limits.bytes)
            return refuse("is not a file that can be included", "write its path as seen from this file");
        std::ostringstream text;
        if (!(text << std::ifstream(path).rdbuf()))
            return refuse("cannot be read");
        open_.push_back(path);
        auto file = read(text.str(), path.string(), path.parent_path());
        open_.pop_back();
        if (file)
            Members(mistakes_, {&file->value, &file->place, ""}, "a swarm file", file_keys);
        return file && file->value.is_object() ? std::move(file) : std::nullopt;
    }

    /// The including file takes precedence.
    void add(PlacedJson& file, const PlacedJson& included)
    {
        for (const auto& [key, place] : included.place.members) {
            if (key == "swarm" || key == "include" || key == "$schema")
                continue;
            const auto& more = included.value.at(key);
            auto* const there = place_of(file.place, key);
            if (!there) {
                file.value[key] = more;
                file.place.members.emplace_back(key, place);
            } else if (auto& own = file.value.at(key); own.is_object() && more.is_object()) {
                add_missing(own, *there, more, place, key == "drones" || key == "defaults" ? 2 : 0);
            } else if (own.is_array() && more.is_array()) {
                own.insert(own.end(), more.begin(), more.end());
                there->items.insert(there->items.end(), place.items.begin(), place.items.end());
            } else {
                mistakes_.at_byte(place.key, key, in_quotes(key) + " is not of the same type as in the including file");
            }
        }
    }

    // --- variables ---

    void resolve_variables(PlacedJson& file)
    {
        const Value root{&file.value, &file.place, ""};
        const auto* place = file.place.member("variables");
        if (place && require_object(mistakes_, root.member("variables", *place)))
            for (const auto& [name, where] : place->members)
                declare(name, root.member("variables", *place).member(name, where));
        std::vector<std::string> names;
        for (const auto& variable : variables_)
            names.push_back(variable.first);
        for (const auto& [name, text] : context_.variables)
            if (const auto found = variables_.find(name); found != variables_.end()) {
                found->second = given_value(text, found->second);
            } else {
                const auto error = no_such("there is no variable " + in_quotes(name) + " to be set", name, names);
                mistakes_.at_byte(place ? place->key : 0, "variables", error.what(), error.advice());
            }
        for (auto& [key, where] : file.place.members)
            if (key != "variables" && key != "include" && key != "$schema")
                resolve(file.value.at(key), where, key);
    }

    void declare(const std::string& name, const Value& value)
    {
        if (!is_name(name))
            mistakes_.at_key(value, in_quotes(name) + " is not the name of a variable");
        else if (value.json->is_structured())
            mistakes_.at_value(value, in_quotes(name) + " must be a number, a text, true, false or null, not "
                                          + shown(*value.json));
        else
            variables_[name] = *value.json;
    }

    void resolve(Json& json, const JsonPlace& place, const std::string& path)
    {
        if (json.is_string())
            json = resolved(json.get<std::string>(), {&json, &place, path});
        for (const auto& [key, where] : place.members)
            resolve(json.at(key), where, path + "." + key);
        for (std::size_t i = 0; i < place.items.size(); ++i)
            resolve(json.at(i), place.items[i], path + "[" + std::to_string(i) + "]");
    }

    /// A text that is only a variable becomes its value, even a number.
    Json resolved(const std::string& text, const Value& where)
    {
        std::string result;
        for (std::size_t i = 0; i < text.size();) {
            const auto end = text.find('}', i);
            if (text.compare(i, 3, "$${") == 0) {
                result += "${";
                i += 3;
            } else if (text.compare(i, 2, "${") != 0) {
                result += text[i++];
            } else if (end == std::string::npos) {
                mistakes_.at_value(where, "${ without a }", "a variable is ${NAME}; write $${ for ${ itself");
                mistakes_.no_more_at(where);
                return text;
            } else {
                const auto value = value_of(text.substr(i + 2, end - i - 2), where);
                if (i == 0 && end + 1 == text.size())
                    return value;
                result += value.is_string() ? value.get<std::string>() : to_text(value);
                i = end + 1;
            }
        }
        return result;
    }

    /// An unknown variable keeps its own text.
    Json value_of(const std::string& name, const Value& where)
    {
        const auto found = variables_.find(name);
        if (found != variables_.end() && !found->second.is_null())
            return found->second;
        std::vector<std::string> names;
        for (const auto& variable : variables_)
            names.push_back(variable.first);
        if (found != variables_.end())
            mistakes_.at_value(where, "the variable " + in_quotes(name) + " has no value",
                               "give it one: --set " + name + "=VALUE");
        else
            mistakes_.at_value(where, no_such("there is no variable " + in_quotes(name), name, names,
                                              "add it to the file: \"variables\": {\"" + name + "\": VALUE}"));
        mistakes_.no_more_at(where);
        return "${" + name + "}";
    }

    // --- defaults ---

    /// @param own  bytes of the file itself: an included file may have defaults that not every including file needs
    void apply_defaults(PlacedJson& file, std::size_t own)
    {
        const Value root{&file.value, &file.place, ""};
        const auto* place = file.place.member("defaults");
        auto* const drones = place_of(file.place, "drones");
        if (!place || !require_object(mistakes_, root.member("defaults", *place)))
            return;
        const auto& defaults = file.value.at("defaults");
        std::map<std::string, bool> used;
        if (drones && file.value.at("drones").is_object())
            for (auto& [name, where] : drones->members) {
                auto& drone = file.value.at("drones").at(name);
                const auto kind = drone.is_object() ? drone.value("kind", Json()) : Json();
                const auto* of_kind = kind.is_string() ? place->member(kind.get<std::string>()) : nullptr;
                if (kind.is_string())
                    used[kind.get<std::string>()] = true;
                if (of_kind && defaults.at(kind.get<std::string>()).is_object())
                    add_missing(drone, where, defaults.at(kind.get<std::string>()), *of_kind, 1);
            }
        std::vector<std::string> kinds;
        for (const auto& kind : used)
            kinds.push_back(kind.first);
        for (const auto& [kind, where] : place->members) {
            const auto value = root.member("defaults", *place).member(kind, where);
            if (require_object(mistakes_, value) && !used.contains(kind) && where.key < own)
                mistakes_.at_key(value,
                                 no_such("no drone of this file is of the kind " + in_quotes(kind), kind, kinds));
        }
    }

    const SwarmContext& context_;
    Texts& texts_;
    Mistakes& mistakes_;
    std::map<std::string, Json> variables_;
    std::vector<fs::path> open_;
    std::size_t files_ = 0;
    bool complete_ = true;
};

}  // namespace

std::optional<Assembled> assemble(std::string_view text, const SwarmContext& context, Texts& texts, Mistakes& mistakes)
{
    return Assembly(context, texts, mistakes).run(text);
}

std::string without_variables(std::string text)
{
    for (auto found = text.find("${"); found != std::string::npos; found = text.find("${", found + 3))
        text.insert(found, 1, '$');
    return text;
}

}  // namespace hive::swarm_file
