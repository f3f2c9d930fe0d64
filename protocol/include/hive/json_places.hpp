// Parses JSON files written by people, and keeps the position of each value in the text.
#pragma once

#include <hive/error.hpp>
#include <hive/json.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hive {

/// The positions of a value and of its parts, in bytes from the beginning of the text.
struct JsonPlace {
    std::size_t key = 0;  ///< of a member: its key; otherwise the same as `value`
    std::size_t value = 0;
    std::vector<std::pair<std::string, JsonPlace>> members = {};  ///< of an object, in the order of the text
    std::vector<JsonPlace> items = {};                            ///< of an array

    /// The position of the member of that name, or nullptr.
    [[nodiscard]] const JsonPlace* member(std::string_view name) const noexcept;
};

/// An error in a text (invalid JSON, or beyond the limits) and its position.
class JsonMistake : public Error {
public:
    JsonMistake(const Error& error, std::size_t at) : Error(error), at_(at) {}
    [[nodiscard]] std::size_t at() const noexcept { return at_; }  ///< in bytes from the beginning

private:
    std::size_t at_;
};

struct PlacedJson {
    Json value;
    JsonPlace place;
};

/// As parse_json, with positions; throws JsonMistake.
PlacedJson parse_placed_json(std::string_view text, const JsonLimits& limits = {});

/// Lines and columns of a text, which must outlive this object; both from 1. A column counts characters, as editors do.
class TextLines {
public:
    explicit TextLines(std::string_view text);
    struct Spot {
        std::size_t line, column;
    };
    [[nodiscard]] Spot at(std::size_t byte) const;

private:
    [[nodiscard]] std::size_t characters_before(std::size_t byte) const;

    std::string_view text_;
    std::vector<std::size_t> begins_{0};   ///< of the lines
    std::vector<std::size_t> counted_{0};  ///< characters before every 256th byte: a file may be one long line
};

}  // namespace hive
