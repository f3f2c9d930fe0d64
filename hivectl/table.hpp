// Rows that are printed as a table for people or as JSON for programs.
#pragma once

#include "terminal.hpp"

#include <hive/json.hpp>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hivectl {

/// One thing and what is known of it, in the order of insertion. Keys name the unit: "uptime_us".
class Row {
public:
    Row() = default;
    Row(std::initializer_list<std::pair<std::string, hive::Json>> fields) : fields_(fields) {}

    Row& add(std::string key, hive::Json value);
    /// Another value for a key that is there.
    Row& set(std::string_view key, hive::Json value);
    /// Null when there is no such key.
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

/// How a value is shown: of a row's field to a text; an empty text is shown as "-".
using Format = std::string (*)(const hive::Json&);

struct Column {
    std::string_view title;
    std::string_view key;
    Format format = nullptr;  ///< null: as it is
    /// Not empty: the column is left out unless a row has something else there than this, nothing, or 0.
    std::string_view usual = {};
    /// On a page with colour: of a value, its colour. Null: none.
    Colour (*colour)(const hive::Json&) = nullptr;
    bool detail = false;  ///< left out if the page is too narrow
};

/// The same column as a detail.
Column detail(Column column);

/// Of the state of a drone or a connection: green if it works, red if it does not run or answer, yellow in between.
Colour state_colour(const hive::Json& state);
/// Of a count of lost events, or a mark for a loss: red if there is one.
Colour loss_colour(const hive::Json& loss);

/// For a column that is left out when it is empty or 0 throughout.
inline constexpr std::string_view nothing = "0";

/// The table with a line of titles. Numbers stand right, texts left; no line ends in spaces. Empty without rows. If the
/// page is too narrow, long texts are shortened; if that is not enough, details are left out, and at last each row
/// becomes a record of several lines.
std::string table_text(const std::vector<Column>& columns, const std::vector<Row>& rows, const Page& page = {});
/// The rows as one JSON array.
std::string json_array(const std::vector<Row>& rows);
/// Writes one of the two to stdout.
void print_rows(Form form, const std::vector<Column>& columns, const std::vector<Row>& rows);

}  // namespace hivectl
