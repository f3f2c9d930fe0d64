// Lays out rows in columns.
#include "words/table.hpp"

#include "words/output.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

namespace hivectl {
namespace {

std::string cell(const Column& column, const hive::Json& value)
{
    std::string text;
    if (value.is_null())
        return column.title.empty() ? "" : "-";  // an empty cell of a column of marks stays empty
    else if (column.format)
        text = column.format(value);
    else
        text = value.is_string() ? value.get<std::string>() : hive::to_text(value);
    return text.empty() ? "-" : printable(text);
}

/// Has any row a value in this column?
bool tells(const Column& column, const std::vector<Row>& rows)
{
    if (column.usual.empty())
        return true;
    return std::ranges::any_of(rows, [&](const Row& row) {
        const auto& value = row[column.key];
        return !value.is_null() && value != 0 && value != false && value != "" && value != column.usual;
    });
}

/// The cells as texts, the titles first, and the layout of each column.
struct Grid {
    std::vector<Column> columns;
    std::vector<std::vector<std::string>> lines;
    std::vector<std::size_t> widths;
    std::vector<bool> right;
};

Grid grid_of(const std::vector<Column>& all_columns, const std::vector<Row>& rows)
{
    Grid grid;
    std::ranges::copy_if(all_columns, std::back_inserter(grid.columns),
                         [&](const Column& column) { return tells(column, rows); });
    auto& titles = grid.lines.emplace_back();
    for (const auto& column : grid.columns) {
        grid.widths.push_back(width(titles.emplace_back(column.title)));
        grid.right.push_back(std::ranges::any_of(rows, [&](const Row& row) { return row[column.key].is_number(); }));
    }
    for (const auto& row : rows) {
        auto& line = grid.lines.emplace_back();
        for (std::size_t i = 0; i < grid.columns.size(); ++i)
            grid.widths[i] =
                std::max(grid.widths[i], width(line.emplace_back(cell(grid.columns[i], row[grid.columns[i].key]))));
    }
    return grid;
}

constexpr std::size_t gap = 2;

/// Narrows the widest text columns; the first stays, since it names the row. False: still too wide.
bool fit(Grid& grid, std::size_t columns)
{
    constexpr std::size_t min_text = 20;
    for (auto used = std::accumulate(grid.widths.begin(), grid.widths.end(), gap * (grid.widths.size() - 1));
         used > columns; --used) {
        std::size_t widest = 0;
        for (std::size_t i = 1; i < grid.widths.size(); ++i)
            if (!grid.right[i] && grid.widths[i] > min_text && (widest == 0 || grid.widths[i] > grid.widths[widest]))
                widest = i;
        if (widest == 0)
            return false;
        --grid.widths[widest];
    }
    return true;
}

std::string painted(const Column& column, const Row* row, const std::string& text, const Page& page)
{
    return page.colour && row && column.colour ? coloured(text, column.colour((*row)[column.key])) : text;
}

/// @param row  null for the titles
std::string line_text(const Grid& grid, const std::vector<std::string>& cells, const Row* row, const Page& page)
{
    std::string text;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto shown = shortened(cells[i], grid.widths[i]);
        const std::string padding(grid.widths[i] - width(shown), ' ');
        text += i == 0 ? "" : std::string(gap, ' ');
        text += grid.right[i] ? padding : "";
        text += painted(grid.columns[i], row, shown, page) + (grid.right[i] ? "" : padding);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
}

/// One record per row: its first cell, then its other non-empty cells with their titles. A field that is longer than a
/// line is broken between words.
std::string record_text(const Grid& grid, const std::vector<std::string>& cells, const Row& row, const Page& page)
{
    std::string text = painted(grid.columns[0], &row, cells[0], page);
    std::size_t used = page.columns;
    for (std::size_t i = 1; i < cells.size(); ++i) {
        if (cells[i].empty() || cells[i] == "-")
            continue;
        const auto& title = grid.lines[0][i];
        const auto size = gap + width(title) + 1 + width(cells[i]);
        if (used + size > page.columns) {
            text += "\n";
            used = 0;
        }
        text += std::string(gap, ' ') + title + " ";
        text += size <= page.columns ? painted(grid.columns[i], &row, cells[i], page)
                                     : wrapped(cells[i], gap + width(title) + 1, 2 * gap, page.columns);
        used += size;
    }
    return text + "\n";
}

std::vector<Column> without_details(std::vector<Column> columns)
{
    std::erase_if(columns, [](const Column& column) { return column.detail; });
    return columns;
}

}  // namespace

Column detail(Column column)
{
    column.detail = true;
    return column;
}

Row& Row::add(std::string key, hive::Json value)
{
    fields_.emplace_back(std::move(key), std::move(value));
    return *this;
}

Row& Row::set(std::string_view key, hive::Json value)
{
    for (auto& [each, old] : fields_)
        if (each == key)
            old = std::move(value);
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

Colour state_colour(const hive::Json& state)
{
    if (state == "idle" || state == "busy" || state == "sending" || state == "connected")
        return Colour::green;
    const bool down =
        state == "gone" || state == "silent" || state == "unreachable" || state == "failed" || state == "crashed";
    return down ? Colour::red : state.is_string() ? Colour::yellow : Colour::none;
}

Colour loss_colour(const hive::Json& loss)
{
    return loss == true || (loss.is_number() && loss > 0) ? Colour::red : Colour::none;
}

std::string table_text(const std::vector<Column>& columns, const std::vector<Row>& rows, const Page& page)
{
    if (rows.empty())
        return {};
    auto grid = grid_of(columns, rows);
    bool fits = page.columns == 0 || fit(grid, page.columns);
    if (!fits) {
        grid = grid_of(without_details(columns), rows);
        fits = fit(grid, page.columns);
    }
    std::string text = fits ? line_text(grid, grid.lines[0], nullptr, page) : "";
    for (std::size_t i = 0; i < rows.size(); ++i)
        text += fits ? line_text(grid, grid.lines[i + 1], &rows[i], page)
                     : record_text(grid, grid.lines[i + 1], rows[i], page);
    return text;
}

std::string json_array(const std::vector<Row>& rows)
{
    std::string text = "[";
    for (const auto& row : rows)
        text += (text.size() > 1 ? "," : "") + row.json();
    return text + "]";
}

void print_rows(Form form, const std::vector<Column>& columns, const std::vector<Row>& rows)
{
    write_out(form == Form::json ? json_array(rows) + "\n" : table_text(columns, rows, page_of(form)));
}

}  // namespace hivectl
