// Parses JSON within limits, and writes it without throwing.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hive {

using Json = nlohmann::json;

/// Limits of a text; a text beyond them is Errc::malformed or Errc::too_large before it costs memory (SPEC.md, 3).
struct JsonLimits {
    std::size_t bytes = 64 * 1024;
    std::size_t depth = 16;
    std::size_t keys = 256;  ///< in one object
    std::size_t string_bytes = 16 * 1024;
    std::size_t values = 64 * 1024;  ///< in all; a header cannot hold this many, a file can
};

/// Parses one JSON text. Throws hive::Error on anything RFC 8259 forbids, on a byte order mark, on invalid UTF-8, on
/// duplicate keys, on numbers that do not fit a double or an integer of 64 bits, and on what exceeds the limits.
Json parse_json(std::string_view text, const JsonLimits& limits = {});

/// Throws Errc::too_large if parse_json would, for the levels, keys or strings of this value.
/// @param around  levels of the text around the value
void require_within(const Json& value, const JsonLimits& limits = {}, std::size_t around = 0);

/// One line of JSON; bytes that are not UTF-8 become U+FFFD.
std::string to_text(const Json& value);

/// `text` in quotation marks with control characters escaped: safe to print, whoever sent it.
std::string in_quotes(std::string_view text);

/// The largest magnitude of an integer field: 2^53, what every language's JSON can hold.
inline constexpr std::int64_t max_json_integer = std::int64_t{1} << 53;
/// The number, when the value is a whole one of at most that magnitude (1.0 is not).
std::optional<std::int64_t> json_integer(const Json& value);

/// Reads the fields of a JSON object from outside; every error is Errc::malformed and names the field.
class Fields {
public:
    /// @param what  the message, for errors: "register"
    Fields(const Json& object, std::string_view what);

    [[nodiscard]] bool has(const char* key) const { return object_.contains(key); }
    [[nodiscard]] std::string text(const char* key) const;
    [[nodiscard]] std::string text_or(const char* key, std::string fallback) const;
    [[nodiscard]] std::string name(const char* key) const;  ///< a text that is_name()
    [[nodiscard]] std::string name_or(const char* key, std::string fallback) const;
    /// A whole number in [low, high].
    [[nodiscard]] std::int64_t integer(const char* key, std::int64_t low, std::int64_t high) const;
    [[nodiscard]] std::int64_t integer_or(const char* key, std::int64_t low, std::int64_t high,
                                          std::int64_t fallback) const;
    [[nodiscard]] bool flag_or(const char* key, bool fallback) const;
    [[nodiscard]] const Json& object(const char* key) const;
    [[nodiscard]] const Json& array(const char* key) const;

private:
    [[nodiscard]] const Json& field(const char* key) const;
    [[noreturn]] void fail(const char* key, std::string_view expected) const;
    const Json& object_;
    std::string what_;
};

}  // namespace hive
