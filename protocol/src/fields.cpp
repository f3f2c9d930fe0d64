// Reads the fields of a message.
#include <hive/error.hpp>
#include <hive/json.hpp>
#include <hive/name.hpp>

namespace hive {

Fields::Fields(const Json& object, std::string_view what) : object_(object), what_(what)
{
    if (!object.is_object())
        throw Error(Errc::malformed, what_ + ": not a JSON object");
}

void Fields::fail(const char* key, std::string_view expected) const
{
    throw Error(Errc::malformed, what_ + ": \"" + key + "\" must be " + std::string(expected));
}

const Json& Fields::field(const char* key) const
{
    const auto found = object_.find(key);
    if (found == object_.end())
        throw Error(Errc::malformed, what_ + ": \"" + key + "\" is missing");
    return *found;
}

std::string Fields::text(const char* key) const
{
    const Json& value = field(key);
    if (!value.is_string())
        fail(key, "a string");
    return value.get<std::string>();
}

std::string Fields::text_or(const char* key, std::string fallback) const
{
    return has(key) ? text(key) : std::move(fallback);
}

std::string Fields::name(const char* key) const
{
    auto value = text(key);
    if (!is_name(value))
        fail(key, "a name");
    return value;
}

std::string Fields::name_or(const char* key, std::string fallback) const
{
    return has(key) ? name(key) : std::move(fallback);
}

std::int64_t Fields::integer(const char* key, std::int64_t low, std::int64_t high) const
{
    const Json& value = field(key);
    const auto number = json_integer(value);
    if (!number || *number < low || *number > high)
        fail(key, "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    return *number;
}

std::int64_t Fields::integer_or(const char* key, std::int64_t low, std::int64_t high, std::int64_t fallback) const
{
    return has(key) ? integer(key, low, high) : fallback;
}

bool Fields::flag_or(const char* key, bool fallback) const
{
    if (!has(key))
        return fallback;
    if (!field(key).is_boolean())
        fail(key, "true or false");
    return field(key).get<bool>();
}

const Json& Fields::object(const char* key) const
{
    const Json& value = field(key);
    if (!value.is_object())
        fail(key, "an object");
    return value;
}

const Json& Fields::array(const char* key) const
{
    const Json& value = field(key);
    if (!value.is_array())
        fail(key, "an array");
    return value;
}

}  // namespace hive
