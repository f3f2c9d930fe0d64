// Checking a parameter's value against its declaration.
#include <hive/error.hpp>
#include <hive/interface.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace hive {
namespace {

std::string shortest(double number)
{
    if (std::abs(number) <= static_cast<double>(max_json_integer) && number == std::trunc(number))
        return std::to_string(static_cast<std::int64_t>(number));  // an integer parameter refuses "6e+05"
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, number).ptr;
    return {text, end};
}

[[noreturn]] void refuse(const ParameterInfo& parameter, const Json& value, std::string_view expected)
{
    const std::string given = value.is_string() ? in_quotes(value.get<std::string>()) : to_text(value).substr(0, 200);
    const std::string range = range_text(parameter);
    throw Error(Errc::refused, parameter.name + "=" + given + ": must be " + std::string(expected)
                                   + (range.empty() ? "" : ", " + range)
                                   + (parameter.unit.empty() ? "" : " " + parameter.unit));
}

template <class Number>
std::optional<Number> parsed(const std::string& text)
{
    Number number{};
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
    return problem == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

bool within(const ParameterInfo& parameter, double number)
{
    return std::isfinite(number) && (!parameter.least || number >= *parameter.least)
           && (!parameter.most || number <= *parameter.most);
}

Json checked_integer(const ParameterInfo& parameter, const Json& value)
{
    const auto number = json_integer(
        value.is_string() ? Json(parsed<std::int64_t>(value.get<std::string>()).value_or(INT64_MIN)) : value);
    if (!number || !within(parameter, static_cast<double>(*number)))
        refuse(parameter, value, "a whole number");
    return *number;
}

Json checked_number(const ParameterInfo& parameter, const Json& value)
{
    std::optional<double> number;
    if (value.is_string())
        number = parsed<double>(value.get<std::string>());
    else if (value.is_number())
        number = value.get<double>();
    if (!number || !within(parameter, *number))
        refuse(parameter, value, "a number");
    return *number;
}

Json checked_flag(const ParameterInfo& parameter, const Json& value)
{
    if (value.is_boolean())
        return value;
    if (value.is_string())
        for (const auto& [text, flag] : {std::pair{"true", true},
                                         {"on", true},
                                         {"yes", true},
                                         {"1", true},
                                         {"false", false},
                                         {"off", false},
                                         {"no", false},
                                         {"0", false}})
            if (value.get<std::string>() == text)
                return flag;
    refuse(parameter, value, "on or off");
}

Json checked_text(const ParameterInfo& parameter, const Json& value)
{
    if (!value.is_string())
        refuse(parameter, value, "a text");
    const auto text = value.get<std::string>();
    if (text.find('\0') != std::string::npos)
        refuse(parameter, value, "a text without NUL");
    if (!parameter.choices.empty() && std::ranges::find(parameter.choices, text) == parameter.choices.end())
        refuse(parameter, value, "one of these");
    return text;
}

}  // namespace

std::string_view token(ParameterType type) noexcept
{
    switch (type) {
    case ParameterType::integer: return "integer";
    case ParameterType::number: return "number";
    case ParameterType::text: return "text";
    case ParameterType::flag: return "flag";
    }
    return {};
}

std::string range_text(const ParameterInfo& parameter)
{
    std::string text;
    for (const auto& choice : parameter.choices)
        text += (text.empty() ? "" : " | ") + choice;
    if (parameter.least && parameter.most)
        text = shortest(*parameter.least) + " to " + shortest(*parameter.most);
    else if (parameter.least)
        text = "at least " + shortest(*parameter.least);
    else if (parameter.most)
        text = "at most " + shortest(*parameter.most);
    return text;
}

Json checked_value(const ParameterInfo& parameter, const Json& value)
{
    switch (parameter.type) {
    case ParameterType::integer: return checked_integer(parameter, value);
    case ParameterType::number: return checked_number(parameter, value);
    case ParameterType::flag: return checked_flag(parameter, value);
    case ParameterType::text: break;
    }
    return checked_text(parameter, value);
}

}  // namespace hive
