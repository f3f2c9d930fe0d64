// What happened between two looks at the status of all drones.
#pragma once

#include "table.hpp"

#include <hive/application.hpp>

#include <chrono>
#include <vector>

namespace hivectl {

struct Rates {
    std::chrono::nanoseconds interval;
    std::vector<Row> drones;  ///< name, state, in_per_s, out_per_s, busy_percent, cpu_percent, memory, age_us, slowest
    std::vector<Row> edges;   ///< from, to, kind, state, what both ends count a second, missing, age_us, why, losing
};

/// Null where there is nothing to compare with: a drone that is new, was restarted in between, or is silent.
Rates rates_between(const std::vector<hive::StatusAnswer>& earlier, const std::vector<hive::StatusAnswer>& now,
                    std::chrono::nanoseconds interval);

std::vector<Column> drone_rate_columns();
std::vector<Column> edge_rate_columns();

}  // namespace hivectl
