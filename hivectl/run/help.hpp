// The texts of --help, for hivectl and for each verb.
#pragma once

#include "verb.hpp"

#include <string>
#include <vector>

namespace hivectl {

/// All verbs by group, and where to read more.
std::string overview(const std::vector<Verb>& all);
/// Everything about one verb; `line` has its options declared.
std::string help_of(const Verb& verb, const CommandLine& line);

}  // namespace hivectl
