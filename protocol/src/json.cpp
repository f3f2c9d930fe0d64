// Parsing with limits, printing safely, reading fields.
#include <hive/error.hpp>
#include <hive/json.hpp>
#include <hive/name.hpp>

#include <set>

namespace hive {
namespace {

/// Builds the value while nlohmann's lexer reads, and stops it at the first excess: a text that would make a deep or
/// wide value is refused before that value exists (nlohmann 3.11.2 crashes on copying or dumping a very deep one).
class LimitedBuilder final : public nlohmann::json_sax<Json> {
public:
    explicit LimitedBuilder(const JsonLimits& limits) : limits_(limits), dom_(result_, false) {}

    bool null() override { return dom_.null(); }
    bool boolean(bool value) override { return dom_.boolean(value); }
    bool number_integer(number_integer_t value) override { return dom_.number_integer(value); }
    bool number_unsigned(number_unsigned_t value) override { return dom_.number_unsigned(value); }
    bool number_float(number_float_t value, const string_t& text) override
    {
        // The lexer turns an integer of over 64 bits into a double: a number that means another one is refused.
        if (text.find_first_of(".eE") == string_t::npos)
            return refuse(Errc::malformed, "a whole number of over 64 bits");
        return dom_.number_float(value, text);
    }
    bool string(string_t& value) override { return fits(value) && dom_.string(value); }
    bool binary(binary_t& value) override { return dom_.binary(value); }
    bool start_object(std::size_t count) override { return deeper() && dom_.start_object(count); }
    bool key(string_t& value) override
    {
        auto& keys = keys_.back();
        if (!fits(value))
            return false;
        if (keys.size() == limits_.keys)
            return refuse(Errc::too_large, "more than " + std::to_string(limits_.keys) + " keys in one object");
        if (!keys.insert(value).second)
            return refuse(Errc::malformed, "the key " + in_quotes(value) + " twice in one object");
        return dom_.key(value);
    }
    bool end_object() override { return shallower() && dom_.end_object(); }
    bool start_array(std::size_t count) override { return deeper() && dom_.start_array(count); }
    bool end_array() override { return shallower() && dom_.end_array(); }
    bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& cause) override
    {
        // nlohmann's text repeats the input; only the place is told.
        return refuse(Errc::malformed, cause.id == 406 ? "a number too large for a double"
                                                       : "an error at byte " + std::to_string(position));
    }

    Json take()
    {
        if (!problem_.empty())
            throw Error(code_, "JSON with " + problem_);
        return std::move(result_);
    }

private:
    bool refuse(Errc code, std::string problem)
    {
        code_ = code;
        problem_ = std::move(problem);
        return false;
    }
    bool fits(const string_t& value)
    {
        return value.size() <= limits_.string_bytes
            || refuse(Errc::too_large, "a string of over " + std::to_string(limits_.string_bytes) + " bytes");
    }
    bool deeper()
    {
        keys_.emplace_back();
        return keys_.size() <= limits_.depth
            || refuse(Errc::too_large, "more than " + std::to_string(limits_.depth) + " levels");
    }
    bool shallower()
    {
        keys_.pop_back();
        return true;
    }

    const JsonLimits& limits_;
    Json result_;
    nlohmann::detail::json_sax_dom_parser<Json> dom_;
    std::vector<std::set<std::string>> keys_;
    Errc code_ = Errc::malformed;
    std::string problem_;
};

}  // namespace

Json parse_json(std::string_view text, const JsonLimits& limits)
{
    if (text.size() > limits.bytes)
        throw Error(Errc::too_large, "JSON of " + std::to_string(text.size()) + " bytes, limit " + std::to_string(limits.bytes));
    if (text.starts_with("\xEF\xBB\xBF"))
        throw Error(Errc::malformed, "JSON with a byte order mark");
    LimitedBuilder builder(limits);
    Json::sax_parse(text.begin(), text.end(), &builder);
    return builder.take();
}

std::string to_text(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string in_quotes(std::string_view text) { return to_text(Json(std::string(text.substr(0, 200)))); }

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
    const bool fits = value.is_number_unsigned() ? value.get<std::uint64_t>() <= static_cast<std::uint64_t>(max_json_integer)
                                                 : value.is_number_integer();
    if (!fits || value.get<std::int64_t>() < low || value.get<std::int64_t>() > high)
        fail(key, "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    return value.get<std::int64_t>();
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
