// What the terminal can show: its width, and colour.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hivectl {

/// How a table is printed.
enum class Form {
    json,
    fitted,  ///< to the width of the terminal; as wide as needed elsewhere
    wide     ///< as wide as needed
};

/// What stands on a page: the zero page is a file or a pipe.
struct Page {
    std::size_t columns = 0;  ///< 0: as wide as needed
    bool colour = false;
};

/// The page that stdout is. Colour only on a terminal, unless $NO_COLOR is set or $TERM is "dumb".
Page page_of(Form form);
/// Columns of the terminal behind a descriptor; 80 if it does not say.
std::size_t columns_of(int descriptor);

/// $TERM says that the terminal only prints.
bool is_dumb_terminal();

enum class Colour { none, green, yellow, red };
/// The text in that colour.
std::string coloured(std::string_view text, Colour colour);

/// Columns that a text takes: code points, which is right for everything but wide scripts.
std::size_t width(std::string_view text);
/// The text in at most so many columns; its end is replaced by an ellipsis if it is longer.
std::string shortened(std::string_view text, std::size_t columns);
/// The words of the text in lines of at most so many columns.
/// @param used    columns of the first line that are taken
/// @param indent  of the other lines
std::string wrapped(std::string_view text, std::size_t used, std::size_t indent, std::size_t columns);

}  // namespace hivectl
