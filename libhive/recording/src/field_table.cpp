#include "csv.hpp"

#include <hive/error.hpp>
#include <hive/recording/field_table.hpp>

#include <algorithm>
#include <charconv>
#include <sstream>

namespace hive::recording {
namespace {

bool has_name(const Json& value)
{
    const auto name = value.is_object() ? value.find("name") : value.end();
    return value.is_object() && name != value.end() && name->is_string();
}

const Json* element(const Json& array, std::string_view word)
{
    const auto named =
        std::ranges::find_if(array, [&](const Json& one) { return has_name(one) && one["name"] == word; });
    if (named != array.end())
        return &*named;
    std::size_t place = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), place);
    return error == std::errc{} && end == word.data() + word.size() && place < array.size() ? &array[place] : nullptr;
}

const Json* member(const Json& value, std::string_view word)
{
    if (value.is_array())
        return element(value, word);
    const auto found = value.is_object() ? value.find(word) : value.end();
    return value.is_object() && found != value.end() ? &*found : nullptr;
}

/// A key may have dots itself, such as the name of a zone: the longest match wins.
const Json* value_at(const Json& value, std::string_view path)
{
    for (auto dot = path.size(); dot != std::string_view::npos && dot > 0; dot = path.rfind('.', dot - 1))
        if (const Json* inner = member(value, path.substr(0, dot)))
            if (const Json* found = dot == path.size() ? inner : value_at(*inner, path.substr(dot + 1)))
                return found;
    return nullptr;
}

std::string cell(const Json& value)
{
    return csv::field(value.is_string() ? value.get<std::string>() : value.is_null() ? "" : value.dump());
}

void collect(const Json& value, const std::string& path, std::vector<std::string>& fields)
{
    const std::string before = path.empty() ? "" : path + ".";
    const auto is_object = [](const Json& one) { return one.is_object(); };
    if (value.is_object()) {
        for (const auto& [key, inner] : value.items())
            collect(inner, before + key, fields);
    } else if (value.is_array() && std::ranges::all_of(value, is_object)) {
        for (std::size_t i = 0; i < value.size(); ++i)
            collect(value[i], before + (has_name(value[i]) ? value[i]["name"].get<std::string>() : std::to_string(i)),
                    fields);
    } else {
        fields.push_back(path);
    }
}

}  // namespace

FieldTable::FieldTable(const std::string& fields)
{
    std::istringstream words(fields + ",");
    for (std::string word; std::getline(words, word, ',');) {
        if (word.empty())
            throw Error(Errc::invalid_argument, "\"" + fields + "\" has an empty field", "write FIELD,FIELD");
        if (std::ranges::count(fields_, word) > 0)
            throw Error(Errc::invalid_argument, "the field " + word + " is named twice", "name it once");
        fields_.push_back(word);
    }
}

std::string FieldTable::heading() const
{
    std::vector<std::string> names;
    std::ranges::transform(fields_, std::back_inserter(names), [](const auto& one) { return csv::field(one); });
    return "source,epoch,seq,time_us,sender,output," + csv::joined(names) + "\n";
}

std::string FieldTable::row(const Event& event)
{
    std::vector<std::string> values{csv::field(event.identity.source),
                                    std::to_string(event.identity.epoch),
                                    std::to_string(event.identity.sequence),
                                    std::to_string(event.identity.captured_us),
                                    csv::field(event.sender),
                                    csv::field(event.output)};
    for (const auto& one : fields_) {
        const Json* value = value_at(event.header, one);
        values.push_back(value ? cell(*value) : "");
        if (value)
            found_.insert(one);
    }
    return csv::joined(values) + "\n";
}

std::vector<std::string> FieldTable::missing() const
{
    std::vector<std::string> fields;
    std::ranges::copy_if(fields_, std::back_inserter(fields), [&](const auto& one) { return !found_.contains(one); });
    return fields;
}

std::vector<std::string> single_fields(const Json& header)
{
    std::vector<std::string> fields;
    collect(header, "", fields);
    return fields;
}

}  // namespace hive::recording
