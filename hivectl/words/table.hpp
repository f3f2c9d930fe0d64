// Prints rows as a table for people or as JSON for programs.
#pragma once

#include "words/terminal.hpp"

#include <hive/json.hpp>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hivectl {

/// Keys and values of one object, in the order of insertion. Keys name the unit: "uptime_us".
class Row {
public:
    Row() = default;
    Row(std::initializer_list<std::pair<std::string, hive::Json>> fields) : fields_(fields) {}

    Row& add(std::string key, hive::Json value);
    /// Replaces the value of an existing key.
    Row& set(std::string_view key, hive::Json value);
    /// Null if there is no such key.
    [[nodiscard]] const hive::Json& operator[](std::string_view key) const;
    /// A number, or 0.
    [[nodiscard]] double number(std::string_view key) const;
    /// A text, or empty.
    [[nodiscard]] std::string text(std::string_view key) const;
    /// One JSON object.
    [[nodiscard]] std::string json() const;

private:
    std::vector<std::pair<std::string, hive::Json>> fields_;
};

/// Formats the field of a row; an empty text is shown as "-".
using Format = std::string (*)(const hive::Json&);

struct Column {
    std::string_view title;
    std::string_view key;
    Format format = nullptr;  ///< null: as it is
    /// Not empty: the column is omitted if every row has this value, nothing, or 0.
    std::string_view usual = {};
    /// The colour of a value, on a page with colour. Null: none.
    Colour (*colour)(const hive::Json&) = nullptr;
    bool detail = false;  ///< omitted if the page is too narrow
};

/// The same column as a detail.
Column detail(Column column);

/// For the state of a drone or connection: green if it works, red if it is not running or does not answer, else yellow.
Colour state_colour(const hive::Json& state);
/// For a count of lost events or a mark of a loss: red if there is one.
Colour loss_colour(const hive::Json& loss);

/// For a column that is omitted if all rows are empty or 0.
inline constexpr std::string_view nothing = "0";

/// The table with a line of titles. Numbers are aligned right, texts left; no line ends in spaces. Empty without rows.
/// If the page is too narrow, long texts are shortened; if that is not enough, details are omitted, and finally each
/// row becomes a record of several lines.
std::string table_text(const std::vector<Column>& columns, const std::vector<Row>& rows, const Page& page = {});
/// The rows as one JSON array.
std::string json_array(const std::vector<Row>& rows);
/// Writes one of the two to stdout.
void print_rows(Form form, const std::vector<Column>& columns, const std::vector<Row>& rows);

}  // namespace hivectl
