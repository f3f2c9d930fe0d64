// The system's text for an error.
#pragma once

#include <string>

namespace hive::transport {

/// "Too many open files"; of an errno.
std::string os_text(int error);

}  // namespace hive::transport
