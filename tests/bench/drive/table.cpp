// Widths, digits, thousands.
#include "table.hpp"

#include <algorithm>
#include <cstdio>
#include <iostream>

namespace hive::bench {
namespace {

std::string with_digits(double value, int digits)
{
    char text[48];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    return text;
}

std::string with_thousands(double value)
{
    auto text = with_digits(value, 0);
    for (auto i = static_cast<std::ptrdiff_t>(text.size()) - 3; i > 0; i -= 3)
        text.insert(static_cast<std::size_t>(i), ",");
    return text;
}

std::string mark(const Figure& figure) { return figure.disturbed ? "*" : ""; }

void print_line(const Cells& cells, const std::vector<std::size_t>& widths)
{
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::string space(widths[i] - cells[i].size(), ' ');
        std::cout << "| " << (i == 0 ? cells[i] + space : space + cells[i]) << ' ';
    }
    std::cout << "|\n";
}

}  // namespace

void print_table(const Cells& head, const std::vector<Cells>& rows)
{
    std::vector<std::size_t> widths;
    for (std::size_t i = 0; i < head.size(); ++i) {
        widths.push_back(head[i].size());
        for (const auto& row : rows)
            widths[i] = std::max(widths[i], row[i].size());
    }
    print_line(head, widths);
    for (const auto width : widths)
        std::cout << '|' << std::string(width + 2, '-');
    std::cout << "|\n";
    for (const auto& row : rows)
        print_line(row, widths);
}

std::string text_of(const std::optional<Figure>& figure)
{
    if (!figure)
        return "-";
    const double value = figure->value;
    return (value >= 1000 ? with_thousands(value)
                          : with_digits(value, value >= 100  ? 0
                                               : value >= 10 ? 1
                                                             : 2))
           + mark(*figure);
}

std::string ratio_text(const std::optional<Figure>& figure)
{
    return figure ? with_digits(figure->value, 2) + mark(*figure) : "-";
}

std::string pair_text(const std::optional<Figure>& p50, const std::optional<Figure>& p99)
{
    return p50 ? text_of(p50) + " / " + text_of(p99) : "-";
}

}  // namespace hive::bench
