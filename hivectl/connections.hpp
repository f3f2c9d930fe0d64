// The connections of a swarm, put together from what both ends say in their status.
#pragma once

#include "table.hpp"

#include <hive/application.hpp>

#include <vector>

namespace hivectl {

/// One row for each connection, and one for each group as a whole, sorted by sender, group and receiver. The keys are
/// those that `hivectl connections --help` explains. Null where the end that would know does not speak.
std::vector<Row> connection_rows(const std::vector<hive::StatusAnswer>& statuses);

}  // namespace hivectl
