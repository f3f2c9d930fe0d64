// Merges a swarm file and its includes into one JSON: resolves comments, variables and defaults, and keeps the position
// of every part in its own file.
#pragma once

#include "values.hpp"

namespace hive::swarm_file {

struct Assembled {
    PlacedJson json;
    bool complete;  ///< false: an included file could not be read
};

/// Adds the files to `texts` and their errors to `mistakes`. Nothing: the file itself is not JSON.
std::optional<Assembled> assemble(std::string_view text, const SwarmContext& context, Texts& texts, Mistakes& mistakes);

/// Escapes a text of a plan for a file: "${" would start a variable.
std::string without_variables(std::string text);

}  // namespace hive::swarm_file
