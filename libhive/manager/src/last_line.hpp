// What a program said last, which usually is why it failed.
#pragma once

#include <sstream>
#include <string>

namespace hive {

/// Without blanks at its end; lines of blanks do not count.
inline std::string last_line(const std::string& text)
{
    std::istringstream lines(text);
    std::string last;
    for (std::string line; std::getline(lines, line);)
        if (const auto end = line.find_last_not_of(" \r"); end != std::string::npos)
            last = line.substr(0, end + 1);
    return last;
}

}  // namespace hive
