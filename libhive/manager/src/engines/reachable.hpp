// Probes for a listener.
#pragma once

#include <string>

namespace hive {

/// Tries to connect for at most 50 ms; sends nothing.
bool reachable(const std::string& host, int port);

}  // namespace hive
