// Does anybody listen there?
#pragma once

#include <string>

namespace hive {

/// Tries to connect, for 50 ms at most; says nothing to whoever is there.
bool reachable(const std::string& host, int port);

}  // namespace hive
