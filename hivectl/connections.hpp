// The connections of a swarm, put together from what both ends say in their status.
#pragma once

#include "table.hpp"

#include <hive/application.hpp>

#include <vector>

namespace hivectl {

/// One row a connection: from, to, transfer, delivery, window, group, encoding, state, known_by ("both", "sender",
/// "receiver"), the sender's counters (produced, delivered, skipped, dropped, abandoned, in_flight), the receiver's
/// age_us and error. Null where the end that would know does not speak. Sorted by from, then to.
std::vector<Row> connection_rows(const std::vector<hive::Answer>& statuses);

}  // namespace hivectl
