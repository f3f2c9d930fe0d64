// A program's last line, usually the reason it failed.
#pragma once

#include <sstream>
#include <string>

namespace hive {

/// Without trailing blanks; blank lines are skipped.
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
