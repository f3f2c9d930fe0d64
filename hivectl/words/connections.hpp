// The connections of a swarm, merged from the statuses of both ends.
#pragma once

#include "words/table.hpp"

#include <hive/application.hpp>

#include <vector>

namespace hivectl {

/// One row per connection, and one per group as a whole, sorted by sender, group and receiver. `hivectl connections
/// --help` explains the keys. A value is null if its end does not answer.
std::vector<Row> connection_rows(const std::vector<hive::StatusAnswer>& statuses);

}  // namespace hivectl
