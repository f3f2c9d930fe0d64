// The width and colour support of the terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hivectl {

/// The width of a table.
enum class Form {
    json,
    fitted,  ///< to the terminal; as wide as needed elsewhere
    wide     ///< as wide as needed
};

/// The output medium: with zero columns a file or a pipe.
struct Page {
    std::size_t columns = 0;  ///< 0: as wide as needed
    bool colour = false;
};

/// The page of stdout. Colour only on a terminal, unless $NO_COLOR is set or $TERM is "dumb".
Page page_of(Form form);
/// Columns of the terminal at a descriptor; 80 if unknown.
std::size_t columns_of(int descriptor);

/// Does $TERM name a terminal that cannot move the cursor?
bool is_dumb_terminal();

enum class Colour { none, green, yellow, red };
/// The text in that colour.
std::string coloured(std::string_view text, Colour colour);

/// Columns that a text takes: code points, which is right for everything but wide scripts.
std::size_t width(std::string_view text);
/// The text in at most this many columns; the end of a longer one is replaced by an ellipsis.
std::string shortened(std::string_view text, std::size_t columns);
/// Wraps the text in lines of at most this many columns.
/// @param used    occupied columns of the first line
/// @param indent  of the other lines
std::string wrapped(std::string_view text, std::size_t used, std::size_t indent, std::size_t columns);

}  // namespace hivectl
