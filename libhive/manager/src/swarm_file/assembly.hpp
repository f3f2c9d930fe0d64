// Makes one JSON of a swarm file and those that it includes: comments, variables and defaults are resolved, and every
// part still knows its place in its own file.
#pragma once

#include "values.hpp"

namespace hive::swarm_file {

struct Assembled {
    PlacedJson json;
    bool complete;  ///< false: a file that it includes could not be read
};

/// What is read is added to `texts`, and what is wrong with it to `mistakes`. Nothing: the file itself is not JSON.
std::optional<Assembled> assemble(std::string_view text, const SwarmContext& context, Texts& texts, Mistakes& mistakes);

/// A text of a plan as it stands in a file: "${" would begin a variable.
std::string without_variables(std::string text);

}  // namespace hive::swarm_file
