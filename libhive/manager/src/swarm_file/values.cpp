// Reads values with their positions.
#include "values.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hive::swarm_file {
namespace {

/// "to" of "connections[0].to", for the sentence.
std::string called(const Value& value)
{
    const auto dot = value.path.rfind('.');
    const auto last = dot == std::string::npos ? value.path : value.path.substr(dot + 1);
    return last.empty() ? "the file" : in_quotes(last);
}

void wrong(Mistakes& mistakes, const Value& value, const std::string& expected)
{
    mistakes.at_value(value, called(value) + " must be " + expected + ", not " + shown(*value.json));
}

}  // namespace

Value Value::member(const std::string& key, const JsonPlace& at) const
{
    return {&json->at(key), &at, path.empty() ? key : path + "." + key};
}

Value Value::item(std::size_t index) const
{
    return {&json->at(index), &place->items.at(index), path + "[" + std::to_string(index) + "]"};
}

std::size_t Texts::add(const std::string& file, std::string text)
{
    const auto begin = texts_.empty() ? 0 : texts_.back().begin + texts_.back().text.size() + 1;
    texts_.emplace_back(file, begin, std::move(text));
    return begin;
}

Texts::Spot Texts::at(std::size_t byte) const
{
    const auto next = std::ranges::upper_bound(texts_, byte, {}, &Text::begin);
    const auto& text = *std::prev(next);
    const auto [line, column] = text.lines.at(byte - text.begin);
    return {text.file, line, column};
}

/// An error in the defaults of a kind would be reported for each drone of that kind.
void Mistakes::at_byte(std::size_t byte, const std::string& path, const std::string& text, const std::string& advice)
{
    const auto [first, last] = found_.equal_range(byte);
    if (silent_.contains(byte)
        || std::any_of(first, last, [&](const auto& found) { return found.second.text == text; }))
        return;
    const auto [file, line, column] = texts_.at(byte);
    found_.emplace(byte, Mistake{line, column, path, text, advice, file});
}

void Mistakes::at_value(const Value& value, const std::string& text, const std::string& advice)
{
    at_byte(value.place->value, value.path, text, advice);
}

void Mistakes::at_key(const Value& value, const std::string& text, const std::string& advice)
{
    at_byte(value.place->key, value.path, text, advice);
}

std::vector<Mistake> Mistakes::take()
{
    std::vector<Mistake> mistakes;
    for (auto& found : found_)
        mistakes.push_back(std::move(found.second));
    return mistakes;
}

Members::Members(Mistakes& mistakes, Value object, std::string_view what, std::span<const std::string_view> keys)
    : mistakes_(mistakes), object_(std::move(object)), what_(what)
{
    if (!require_object(mistakes_, object_))
        return;
    for (const auto& [key, place] : object_.place->members) {
        if (std::ranges::find(keys, key) != keys.end())
            continue;
        const auto near = nearest(key, keys);
        mistakes_.at_key(object_.member(key, place), what_ + " has no key " + in_quotes(key),
                         near.empty() ? "it may have " + listed(keys) : "did you mean " + in_quotes(near) + "?");
    }
}

std::optional<Value> Members::find(std::string_view key) const
{
    const auto* place = object_.json->is_object() ? object_.place->member(key) : nullptr;
    return place ? std::optional(object_.member(std::string(key), *place)) : std::nullopt;
}

std::optional<Value> Members::require(std::string_view key)
{
    auto found = find(key);
    if (!found && object_.json->is_object())
        mistakes_.at_value(object_, what_ + " must have the key " + in_quotes(key));
    return found;
}

std::optional<std::string> Members::text(std::string_view key)
{
    const auto value = find(key);
    return value ? text_of(mistakes_, *value) : std::nullopt;
}

std::optional<std::string> Members::word(std::string_view key, std::span<const std::string_view> words)
{
    const auto value = find(key);
    if (!value)
        return std::nullopt;
    if (value->json->is_string() && std::ranges::find(words, value->json->get<std::string>()) != words.end())
        return value->json->get<std::string>();
    wrong(mistakes_, *value, listed(words));
    return std::nullopt;
}

std::optional<std::int64_t> Members::integer(std::string_view key, std::int64_t least, std::int64_t most)
{
    const auto value = find(key);
    if (!value)
        return std::nullopt;
    if (const auto number = json_integer(*value->json); number && *number >= least && *number <= most)
        return number;
    wrong(mistakes_, *value, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    return std::nullopt;
}

bool Members::flag(std::string_view key)
{
    const auto value = find(key);
    if (value && !value->json->is_boolean())
        wrong(mistakes_, *value, "true or false");
    return value && value->json->is_boolean() && value->json->get<bool>();
}

std::optional<std::string> text_of(Mistakes& mistakes, const Value& value)
{
    if (value.json->is_string() && !value.json->get_ref<const std::string&>().empty())
        return value.json->get<std::string>();
    wrong(mistakes, value, "a text");
    return std::nullopt;
}

std::vector<std::pair<std::string, Value>> texts_of(Mistakes& mistakes, const Value& value)
{
    std::vector<std::pair<std::string, Value>> texts;
    const auto add = [&](const Value& one) {
        if (const auto text = text_of(mistakes, one))
            texts.emplace_back(*text, one);
    };
    if (value.json->is_string())
        add(value);
    else if (value.json->is_array() && !value.json->empty())
        for (std::size_t i = 0; i < value.json->size(); ++i)
            add(value.item(i));
    else
        wrong(mistakes, value, "a text or a list of texts");
    return texts;
}

std::string shown(const Json& value)
{
    if (value.is_string())
        return in_quotes(value.get<std::string>());
    if (value.is_object())
        return "an object";
    if (value.is_array())
        return value.empty() ? "an empty list" : "a list";
    return to_text(value);
}

bool require_object(Mistakes& mistakes, const Value& value)
{
    if (!value.json->is_object())
        wrong(mistakes, value, "an object");
    return value.json->is_object();
}

std::string listed(std::span<const std::string_view> words)
{
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i)
        text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + std::string(words[i]);
    return text;
}

}  // namespace hive::swarm_file
