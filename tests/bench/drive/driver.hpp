// Runs rows in rounds, all rows of a column back to back, and writes one line of JSON for each run.
#pragma once

#include "plan.hpp"

#include <filesystem>

namespace hive::bench {

struct DriveOptions {
    std::filesystem::path out = "build/bench.jsonl";
    std::string only = ".*";    ///< rows: a regular expression that fits a part of "raw_shm/copy"
    std::string column = ".*";  ///< columns
    int rounds = 3;
    int laps = 3;          ///< pairs of Hive and limit in each round
    double budget = 450;   ///< seconds; what is not run by then is left out
    int frames = 30;       ///< of each latency run
    double seconds = 0.2;  ///< of each other run
};

/// Throws std::runtime_error when nothing fits or the file cannot be written.
void drive(const DriveOptions& options);

/// A few frames through Hive and the limits, every test; false when any was lost or corrupt.
bool smoke();

/// Another process may use this much of one core before a run counts as disturbed.
constexpr double most_foreign = 0.25;

}  // namespace hive::bench
