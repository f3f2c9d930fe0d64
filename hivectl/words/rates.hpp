// Rates from two statuses of all drones.
#pragma once

#include "words/table.hpp"

#include <hive/application.hpp>

#include <chrono>
#include <vector>

namespace hivectl {

struct Rates {
    std::chrono::nanoseconds interval;
    std::vector<Row> drones;  ///< name, state, in_per_s, out_per_s, busy_percent, cpu_percent, memory, age_us, slowest
    std::vector<Row> edges;   ///< from, to, kind, state, the rates of both ends, missing, age_us, why, losing
};

/// A rate is null without an earlier status: the drone is new, was restarted in between, or is silent.
Rates rates_between(const std::vector<hive::StatusAnswer>& earlier, const std::vector<hive::StatusAnswer>& now,
                    std::chrono::nanoseconds interval);

std::vector<Column> drone_rate_columns();
std::vector<Column> edge_rate_columns();

}  // namespace hivectl
