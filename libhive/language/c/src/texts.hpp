// Texts and JSON in arguments and results of the ABI.
#pragma once

#include "errors.hpp"

#include <hive/json.hpp>

#include <chrono>
#include <string>

namespace hive::c {

/// The text, or "" for null.
inline std::string text_or_empty(const char* text) { return text ? text : ""; }
/// Throws Errc::invalid_argument for null.
std::string text_of(const char* text, const char* what);

/// Parses JSON of the caller; throws Errc::invalid_argument. Null: the fallback.
Json json_of(const char* text, const char* what, Json fallback = Json::object());
/// The same with a length, for headers: an object.
Json header_of(const char* text, std::size_t length);
/// An object.
Json object_of(const char* text, const char* what);
/// An array of texts. Null: none.
std::vector<std::string> names_of(const char* text, const char* what);

/// Fields of options; errors are Errc::invalid_argument naming the field.
class Options {
public:
    /// Throws for a field that is not among `known`.
    Options(const char* text, const std::vector<const char*>& known);
    [[nodiscard]] std::string text(const char* field) const;
    [[nodiscard]] bool flag(const char* field) const;
    [[nodiscard]] std::int64_t integer(const char* field, std::int64_t least, std::int64_t fallback) const;
    [[nodiscard]] std::optional<double> number(const char* field) const;
    [[nodiscard]] Json object(const char* field) const;
    [[nodiscard]] std::vector<std::string> texts(const char* field) const;

private:
    [[nodiscard]] const Json* find(const char* field) const;
    Json values_;
};

/// A copy for the caller, who frees it. `length` may be null.
void give_text(const std::string& text, char** out, std::size_t* length = nullptr);
inline void give_json(const Json& value, char** out, std::size_t* length = nullptr)
{
    give_text(to_text(value), out, length);
}

/// A timeout of the caller in milliseconds: not negative, at most a day.
std::chrono::milliseconds timeout_of(std::int64_t milliseconds);

}  // namespace hive::c
