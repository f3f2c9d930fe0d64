// Reads texts of the caller, and returns texts to it.
#include "texts.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>

namespace hive::c {
namespace {

[[noreturn]] void refuse(const std::string& text) { throw Error(Errc::invalid_argument, text); }

Json parsed(std::string_view text, const char* what)
try {
    return parse_json(text);
} catch (const Error& error) {
    throw Error(error.code() == Errc::malformed ? Errc::invalid_argument : error.code(),
                std::string(what) + ": " + error.what());
}

}  // namespace

std::string text_of(const char* text, const char* what) { return required(text, what); }

Json json_of(const char* text, const char* what, Json fallback)
{
    return text ? parsed(text, what) : std::move(fallback);
}

Json header_of(const char* text, std::size_t length)
{
    if (!text)
        return Json::object();
    Json header = parsed({text, length}, "the header");
    if (!header.is_object())
        refuse("the header is not a JSON object");
    return header;
}

Json object_of(const char* text, const char* what)
{
    Json object = json_of(required(text, what), what);
    if (!object.is_object())
        refuse(std::string(what) + " are not a JSON object");
    return object;
}

std::vector<std::string> names_of(const char* text, const char* what)
{
    const Json list = json_of(text, what, Json::array());
    if (!list.is_array() || !std::ranges::all_of(list, [](const Json& item) { return item.is_string(); }))
        refuse(std::string(what) + " is not an array of texts");
    return list.get<std::vector<std::string>>();
}

Options::Options(const char* text, const std::vector<const char*>& known) : values_(json_of(text, "the options"))
{
    if (!values_.is_object())
        refuse("the options are not a JSON object");
    for (const auto& [field, value] : values_.items())
        if (std::ranges::find(known, field) == known.end())
            refuse("there is no option " + in_quotes(field));
}

const Json* Options::find(const char* field) const
{
    const auto found = values_.find(field);
    return found == values_.end() || found->is_null() ? nullptr : &*found;
}

std::string Options::text(const char* field) const
{
    const Json* value = find(field);
    if (value && !value->is_string())
        refuse("option " + in_quotes(field) + " is not a text");
    return value ? value->get<std::string>() : std::string();
}

bool Options::flag(const char* field) const
{
    const Json* value = find(field);
    if (value && !value->is_boolean())
        refuse("option " + in_quotes(field) + " is neither true nor false");
    return value && value->get<bool>();
}

std::int64_t Options::integer(const char* field, std::int64_t least, std::int64_t fallback) const
{
    const Json* value = find(field);
    if (!value)
        return fallback;
    const auto number = json_integer(*value);
    if (!number || *number < least)
        refuse("option " + in_quotes(field) + " is not a whole number of at least " + std::to_string(least));
    return *number;
}

std::optional<double> Options::number(const char* field) const
{
    const Json* value = find(field);
    if (value && !value->is_number())
        refuse("option " + in_quotes(field) + " is not a number");
    return value ? std::optional(value->get<double>()) : std::nullopt;
}

Json Options::object(const char* field) const
{
    const Json* value = find(field);
    if (value && !value->is_object())
        refuse("option " + in_quotes(field) + " is not a JSON object");
    return value ? *value : Json::object();
}

std::vector<std::string> Options::texts(const char* field) const
{
    const Json* value = find(field);
    return value ? names_of(to_text(*value).c_str(), field) : std::vector<std::string>();
}

void give_text(const std::string& text, char** out, std::size_t* length)
{
    required(out, "the place for the result");
    auto* copy = static_cast<char*>(std::malloc(text.size() + 1));
    if (!copy)
        throw std::bad_alloc();
    std::memcpy(copy, text.c_str(), text.size() + 1);
    *out = copy;
    if (length)
        *length = text.size();
}

std::chrono::milliseconds timeout_of(std::int64_t milliseconds)
{
    return std::chrono::milliseconds(std::clamp<std::int64_t>(milliseconds, 0, 24 * 3600 * 1000));
}

}  // namespace hive::c

void hive_free(void* text) { std::free(text); }
