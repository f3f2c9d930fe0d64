// Parses with limits, and prints safely.
#include "json_places.hpp"

#include <hive/error.hpp>
#include <hive/json.hpp>
#include <hive/plain_text.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

namespace hive {
namespace {

// The error of each limit, for reading and for writing.
std::string too_deep(const JsonLimits& limits) { return "more than " + std::to_string(limits.depth) + " levels"; }
std::string too_wide(const JsonLimits& limits)
{
    return "more than " + std::to_string(limits.keys) + " keys in one object";
}
std::string too_long(const JsonLimits& limits)
{
    return "a string of over " + std::to_string(limits.string_bytes) + " bytes";
}

/// Builds the value while nlohmann's lexer reads, and stops at the first limit: a deep or wide value is refused before
/// it exists (nlohmann 3.11.2 crashes on copying or dumping a very deep one).
class LimitedBuilder final : public nlohmann::json_sax<Json> {
public:
    /// @param places  gets each token; null: not needed
    explicit LimitedBuilder(const JsonLimits& limits, PlaceWriter* places = nullptr) : limits_(limits), places_(places)
    {
    }

    bool null() override { return add(nullptr); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(number_integer_t value) override { return add(value); }
    bool number_unsigned(number_unsigned_t value) override { return add(value); }
    bool number_float(number_float_t value, const string_t& text) override
    {
        // The lexer turns an integer of over 64 bits into a double, which is another number and so refused.
        if (text.find_first_of(".eE") == string_t::npos)
            return refuse(Errc::malformed, "a whole number of over 64 bits");
        return add(value);
    }
    bool string(string_t& value) override { return fits(value) && add(std::move(value)); }
    bool binary(binary_t&) override { return refuse(Errc::malformed, "a binary value"); }
    bool start_object(std::size_t) override { return open(Json::value_t::object); }
    bool key(string_t& value) override
    {
        auto& object = *open_.back()->get_ptr<Json::object_t*>();
        if (!fits(value))
            return false;
        if (object.size() == limits_.keys)
            return refuse(Errc::too_large, too_wide(limits_));
        const auto [place, is_new] = object.try_emplace(std::move(value));
        if (!is_new)
            return refuse(Errc::malformed, "duplicate key " + in_quotes(place->first));
        slot_ = &place->second;
        if (places_)
            places_->key(place->first);
        return true;
    }
    bool end_object() override { return close(); }
    bool start_array(std::size_t) override { return open(Json::value_t::array); }
    bool end_array() override { return close(); }
    bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& cause) override
    {
        error_at_ = position;
        if (cause.id == 406)
            return refuse(Errc::malformed, "a number too large for a double");
        // nlohmann's text repeats the input; report only the position.
        return refuse(Errc::malformed, places_ ? "unexpected input" : "an error at byte " + std::to_string(position));
    }

    /// The number of bytes read when the text turned out to be invalid; 0: it is valid, or a limit came first.
    [[nodiscard]] std::size_t error_at() const noexcept { return error_at_; }
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
        return value.size() <= limits_.string_bytes || refuse(Errc::too_large, too_long(limits_));
    }
    /// Inserts a value at the current position: the end of the open array, or the slot of the last key.
    template <class Value>
    bool add(Value&& value)
    {
        if (++values_ > limits_.values)
            return refuse(Errc::too_large, "more than " + std::to_string(limits_.values) + " values");
        if (places_)
            places_->value();
        if (!open_.empty() && open_.back()->is_array())
            slot_ = &open_.back()->get_ptr<Json::array_t*>()->emplace_back(std::forward<Value>(value));
        else
            *slot_ = std::forward<Value>(value);
        return true;
    }
    bool open(Json::value_t type)
    {
        if (open_.size() == limits_.depth)
            return refuse(Errc::too_large, too_deep(limits_));
        if (!add(type))
            return false;
        if (places_)
            places_->open(type == Json::value_t::object);
        open_.push_back(slot_);
        return true;
    }
    bool close()
    {
        open_.pop_back();
        if (places_)
            places_->close();
        return true;
    }

    const JsonLimits& limits_;
    PlaceWriter* places_;
    Json result_;
    Json* slot_ = &result_;    ///< the place of the next value, unless an array is open
    std::vector<Json*> open_;  ///< the objects and arrays around it, outermost first
    std::size_t values_ = 0, error_at_ = 0;
    Errc code_ = Errc::malformed;
    std::string problem_;
};

void require_readable(std::string_view text, const JsonLimits& limits)
{
    require_at_most("JSON", text.size(), limits.bytes);
    if (text.starts_with("\xEF\xBB\xBF"))
        throw Error(Errc::malformed, "JSON with a byte order mark");
    if (text.find('\0') != std::string_view::npos)  // nlohmann's lexer would treat it as the end
        throw Error(Errc::malformed, "JSON with a NUL byte");
}

/// The position of the error: the refused token, or a superfluous ',' or ':' before it.
std::size_t place_of_mistake(const LimitedBuilder& builder, const PlaceWriter& places)
{
    const auto token = places.next_token();
    return builder.error_at() == 0 ? token : std::min(builder.error_at() - 1, token);
}

}  // namespace

Json parse_json(std::string_view text, const JsonLimits& limits)
{
    require_readable(text, limits);
    LimitedBuilder builder(limits);
    Json::sax_parse(text.begin(), text.end(), &builder);
    return builder.take();
}

PlacedJson parse_placed_json(std::string_view text, const JsonLimits& limits)
{
    PlaceWriter places(text);
    LimitedBuilder builder(limits, &places);
    const auto nul = text.find('\0');
    std::size_t at = nul == std::string_view::npos ? 0 : nul;
    try {
        require_readable(text, limits);
        Json::sax_parse(text.begin(), text.end(), &builder);
        at = place_of_mistake(builder, places);
        auto value = builder.take();
        return {std::move(value), places.take()};
    } catch (const Error& error) {
        throw JsonMistake(error, at);
    }
}

void require_within(const Json& value, const JsonLimits& limits, std::size_t around)
{
    const auto refuse = [](const std::string& problem) { throw Error(Errc::too_large, "JSON with " + problem); };
    const auto check_text = [&](const std::string& text) {
        if (text.size() > limits.string_bytes)
            refuse(too_long(limits));
    };
    if (value.is_string())
        return check_text(value.get_ref<const std::string&>());
    if (!value.is_structured())
        return;
    if (around >= limits.depth)
        refuse(too_deep(limits));
    if (value.is_object() && value.size() > limits.keys)
        refuse(too_wide(limits));
    if (value.is_object())
        for (const auto& [key, item] : value.get_ref<const Json::object_t&>())
            check_text(key);
    for (const Json& item : value)
        require_within(item, limits, around + 1);
}

namespace {

std::string dumped(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

template <class Integer>
void append(std::string& text, Integer number)
{
    std::array<char, 24> digits{};
    const auto* end = std::to_chars(digits.begin(), digits.end(), number).ptr;
    text.append(digits.data(), static_cast<std::size_t>(end - digits.data()));
}

void append_comma(std::string& text)
{
    if (text.back() != '{' && text.back() != '[')
        text += ',';
}

/// As dumped(), which takes several times as long for plain texts and whole numbers.
void append(std::string& text, const Json& value)
{
    switch (value.type()) {
    case Json::value_t::object:
        text += '{';
        for (const auto& [key, item] : value.get_ref<const Json::object_t&>()) {
            append_comma(text);
            append_quoted(text, key);
            text += ':';
            append(text, item);
        }
        text += '}';
        break;
    case Json::value_t::array:
        text += '[';
        for (const Json& item : value) {
            append_comma(text);
            append(text, item);
        }
        text += ']';
        break;
    case Json::value_t::string: append_quoted(text, value.get_ref<const std::string&>()); break;
    case Json::value_t::number_integer: append(text, value.get<std::int64_t>()); break;
    case Json::value_t::number_unsigned: append(text, value.get<std::uint64_t>()); break;
    case Json::value_t::boolean: text += value.get<bool>() ? "true" : "false"; break;
    default: text += dumped(value);
    }
}

}  // namespace

void append_quoted(std::string& text, const std::string& value)
{
    if (std::ranges::all_of(value, is_plain))
        ((text += '"') += value) += '"';
    else
        text += dumped(value);
}

std::string to_text(const Json& value)
{
    std::string text;
    append(text, value);
    return text;
}

std::string in_quotes(std::string_view text)
{
    const std::string quoted = to_text(Json(std::string(text.substr(0, 200))));
    std::string safe;
    for (std::size_t i = 0; i < quoted.size(); ++i) {
        // nlohmann escapes only C0; DEL and C1 (C2 80 to C2 9F in UTF-8) control terminals, too.
        const bool c1 = quoted[i] == '\xC2' && static_cast<unsigned char>(quoted[i + 1]) < 0xA0;
        if (quoted[i] != '\x7F' && !c1) {
            safe += quoted[i];
            continue;
        }
        constexpr std::string_view digits = "0123456789abcdef";
        const auto code = static_cast<unsigned char>(c1 ? quoted[++i] : quoted[i]);
        safe += "\\u00";
        safe += {digits[code >> 4], digits[code & 15]};
    }
    return safe;
}

std::optional<std::int64_t> json_integer(const Json& value)
{
    if (!value.is_number_integer())
        return std::nullopt;
    if (value.is_number_unsigned() && value.get<std::uint64_t>() > static_cast<std::uint64_t>(max_json_integer))
        return std::nullopt;
    const auto number = value.get<std::int64_t>();
    return number >= -max_json_integer && number <= max_json_integer ? std::optional(number) : std::nullopt;
}

}  // namespace hive
