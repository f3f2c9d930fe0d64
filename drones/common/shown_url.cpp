// Hides the login, removes the query, and truncates long texts.
#include "shown_url.hpp"

#include <algorithm>

namespace capture {

std::string shown_url(std::string text)
{
    if (const auto slashes = text.find("://"); slashes != std::string::npos) {
        const std::size_t begin = slashes + 3, end = text.find_first_of("/?# ", begin);
        const std::size_t at = text.substr(0, end).rfind('@');
        if (at != std::string::npos && at >= begin)
            text.replace(begin, at - begin, "***");
    }
    text.resize(std::min(text.find('?'), text.size()));
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7E)
            c = '.';
    return text.size() > 200 ? text.substr(0, 200) + "..." : text;
}

}  // namespace capture
