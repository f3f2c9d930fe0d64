#include "csv.hpp"

#include <algorithm>

namespace hive::recording::csv {

std::string field(std::string text)
{
    std::ranges::replace_if(
        text, [](unsigned char letter) { return letter < 32 || letter == 127; }, ' ');
    if (text.find_first_of(",\"") == std::string::npos)
        return text;
    for (auto at = text.find('"'); at != std::string::npos; at = text.find('"', at + 2))
        text.insert(at, 1, '"');
    return '"' + text + '"';
}

std::string joined(const std::vector<std::string>& fields)
{
    std::string line;
    for (const auto& one : fields)
        line += (&one == &fields.front() ? "" : ",") + one;
    return line;
}

}  // namespace hive::recording::csv
