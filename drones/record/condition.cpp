#include "condition.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace record {
namespace {

using nlohmann::json;

constexpr std::array<std::string_view, 7> operations{"", "=", "!=", "<", "<=", ">", ">="};

std::vector<std::string> parts(const std::string& text, char between)
{
    std::vector<std::string> all;
    std::istringstream stream(text + between);
    for (std::string part; std::getline(stream, part, between);)
        all.push_back(part);
    return all;
}

std::string trimmed(const std::string& text)
{
    const auto first = text.find_first_not_of(' ');
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::optional<double> number(const std::string& text)
{
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

std::optional<double> number(const json& value)
{
    if (value.is_number())
        return value.get<double>();
    return value.is_array() ? std::optional(static_cast<double>(value.size())) : std::nullopt;
}

template <class Value>
bool compare(const Value& one, const std::string& operation, const Value& other)
{
    if (operation == "=")
        return one == other;
    if (operation == "!=")
        return one != other;
    if (operation == "<")
        return one < other;
    if (operation == "<=")
        return one <= other;
    return operation == ">" ? one > other : one >= other;
}

}  // namespace

Condition::Condition(const std::string& text)
{
    if (trimmed(text) == "*")
        return;
    for (const auto& part : parts(text, ','))
        all_.push_back(comparison(part));
}

Condition::Comparison Condition::comparison(const std::string& text)
{
    const auto at = text.find_first_of("=!<>");
    const auto behind = std::min(text.find_first_not_of("=!<>", at), text.size());
    Comparison one{parts(trimmed(text.substr(0, at)), '.'), at < behind ? text.substr(at, behind - at) : "",
                   trimmed(text.substr(behind))};
    if (one.operation == "==")
        one.operation = "=";
    if (std::ranges::find(operations, one.operation) == operations.end() || std::ranges::count(one.path, "") > 0
        || (!one.operation.empty() && one.value.empty()))
        throw std::invalid_argument("\"" + text + "\" is not FIELD, FIELD=VALUE, !=, <, <=, >, >=");
    return one;
}

bool Condition::holds(const json& header) const
{
    return std::ranges::all_of(all_, [&](const Comparison& one) { return holds(one, header, 0); });
}

bool Condition::holds(const Comparison& one, const json& value, std::size_t step)
{
    if (step == one.path.size())
        return fits(one, value);
    if (value.is_array())
        return std::ranges::any_of(value, [&](const json& element) { return holds(one, element, step); });
    const auto found = value.is_object() ? value.find(one.path[step]) : value.end();
    return value.is_object() && found != value.end() && holds(one, *found, step + 1);
}

bool Condition::fits(const Comparison& one, const json& value)
{
    if (one.operation.empty())
        return !(value.is_null() || value == json(false) || value == json(0) || value == json("")
                 || (value.is_structured() && value.empty()));
    if (const auto wanted = number(one.value), is = number(value); wanted && is)
        return compare(*is, one.operation, *wanted);
    return compare(value.is_string() ? value.get<std::string>() : value.dump(), one.operation, one.value);
}

}  // namespace record
