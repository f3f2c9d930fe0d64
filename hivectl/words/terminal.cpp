#include "words/terminal.hpp"

#include "words/output.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>

namespace hivectl {
namespace {

bool wants_colour()
{
    const char* const no_colour = std::getenv("NO_COLOR");
    return !(no_colour && *no_colour) && !is_dumb_terminal();
}

bool begins_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }

}  // namespace

Page page_of(Form form)
{
    if (!on_terminal())
        return {};
    return {.columns = form == Form::wide ? 0 : columns_of(STDOUT_FILENO), .colour = wants_colour()};
}

std::size_t columns_of(int descriptor)
{
    winsize size{};
    return ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

bool is_dumb_terminal()
{
    const char* const terminal = std::getenv("TERM");
    return std::string_view(terminal ? terminal : "") == "dumb";
}

std::string coloured(std::string_view text, Colour colour)
{
    if (colour == Colour::none || text.empty())
        return std::string(text);
    const char* const start = colour == Colour::green ? "\x1b[32m" : colour == Colour::yellow ? "\x1b[33m" : "\x1b[31m";
    return start + std::string(text) + "\x1b[0m";
}

std::size_t width(std::string_view text)
{
    return static_cast<std::size_t>(std::ranges::count_if(text, begins_character));
}

std::string shortened(std::string_view text, std::size_t columns)
{
    if (width(text) <= columns)
        return std::string(text);
    std::size_t end = 0;
    for (std::size_t shown = 0; end < text.size(); ++end)
        if (begins_character(text[end]) && ++shown == std::max<std::size_t>(columns, 1))
            break;
    return std::string(text.substr(0, end)) + "\xE2\x80\xA6";
}

std::string wrapped(std::string_view text, std::size_t used, std::size_t indent, std::size_t columns)
{
    std::string result;
    std::istringstream words{std::string(text)};
    bool first = true;  // of its line
    for (std::string word; words >> word; first = false) {
        if (!first && used + 1 + width(word) > columns) {
            result += "\n" + std::string(indent, ' ');
            used = indent;
        } else if (!first) {
            result += ' ';
            ++used;
        }
        result += word;
        used += width(word);
    }
    return result;
}

}  // namespace hivectl
