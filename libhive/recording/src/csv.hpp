// Fields of comma-separated values, RFC 4180 except for line ends of "\n".
#pragma once

#include <string>
#include <vector>

namespace hive::recording::csv {

/// Control characters could control a terminal, and would break lines.
std::string field(std::string text);
std::string joined(const std::vector<std::string>& fields);

}  // namespace hive::recording::csv
