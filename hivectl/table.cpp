// Laying out rows in columns.
#include "table.hpp"

#include "output.hpp"

#include <algorithm>
#include <iterator>

namespace hivectl {
namespace {

/// Code points, which is the width of everything but wide scripts.
std::size_t width(std::string_view text)
{
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string cell(const Column& column, const hive::Json& value)
{
    std::string text;
    if (value.is_null())
        return column.title.empty() ? "" : "-";  // a column of marks is empty where there is none
    else if (column.format)
        text = column.format(value);
    else
        text = value.is_string() ? value.get<std::string>() : hive::to_text(value);
    return text.empty() ? "-" : printable(text);
}

/// Does any row say something in this column?
bool tells(const Column& column, const std::vector<Row>& rows)
{
    if (column.usual.empty())
        return true;
    return std::ranges::any_of(rows, [&](const Row& row) {
        const auto& value = row[column.key];
        return !value.is_null() && value != 0 && value != false && value != "" && value != column.usual;
    });
}

struct Line {
    std::vector<std::string> cells;
};

std::string laid_out(const Line& line, const std::vector<std::size_t>& widths, const std::vector<bool>& right)
{
    std::string text;
    for (std::size_t i = 0; i < line.cells.size(); ++i) {
        const std::string padding(widths[i] - width(line.cells[i]), ' ');
        text += i == 0 ? "" : "  ";
        text += right[i] ? padding + line.cells[i] : line.cells[i] + padding;
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
}

}  // namespace

Row& Row::add(std::string key, hive::Json value)
{
    fields_.emplace_back(std::move(key), std::move(value));
    return *this;
}

const hive::Json& Row::operator[](std::string_view key) const
{
    static const hive::Json absent;
    const auto found =
        std::ranges::find(fields_, key, [](const auto& field) -> std::string_view { return field.first; });
    return found == fields_.end() ? absent : found->second;
}

double Row::number(std::string_view key) const
{
    const auto& value = (*this)[key];
    return value.is_number() ? value.get<double>() : 0;
}

std::string Row::text(std::string_view key) const
{
    const auto& value = (*this)[key];
    return value.is_string() ? value.get<std::string>() : std::string();
}

std::string Row::json() const
{
    std::string text = "{";
    for (const auto& [key, value] : fields_)
        text += (text.size() > 1 ? "," : "") + json_text(key) + ":" + json_text(value);
    return text + "}";
}

std::string table_text(const std::vector<Column>& all_columns, const std::vector<Row>& rows)
{
    if (rows.empty())
        return {};
    std::vector<Column> columns;
    std::ranges::copy_if(all_columns, std::back_inserter(columns),
                         [&](const Column& column) { return tells(column, rows); });
    std::vector<Line> lines(1);
    std::vector<std::size_t> widths;
    std::vector<bool> right;
    for (const auto& column : columns) {
        lines[0].cells.emplace_back(column.title);
        widths.push_back(width(column.title));
        right.push_back(std::ranges::any_of(rows, [&](const Row& row) { return row[column.key].is_number(); }));
    }
    for (const auto& row : rows) {
        Line& line = lines.emplace_back();
        for (std::size_t i = 0; i < columns.size(); ++i)
            widths[i] = std::max(widths[i], width(line.cells.emplace_back(cell(columns[i], row[columns[i].key]))));
    }
    std::string text;
    for (const auto& line : lines)
        text += laid_out(line, widths, right);
    return text;
}

std::string json_array(const std::vector<Row>& rows)
{
    std::string text = "[";
    for (const auto& row : rows)
        text += (text.size() > 1 ? "," : "") + row.json();
    return text + "]";
}

void print_rows(bool json, const std::vector<Column>& columns, const std::vector<Row>& rows)
{
    write_out(json ? json_array(rows) + "\n" : table_text(columns, rows));
}

}  // namespace hivectl
