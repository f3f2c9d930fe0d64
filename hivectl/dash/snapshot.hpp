// The state of a swarm for the page, computed from the last answers of all drones. Queries no drone.
#pragma once

#include <hive/application.hpp>
#include <hive/audit.hpp>
#include <hive/explain.hpp>
#include <hive/graph.hpp>

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace hivectl::dash {

/// The answers of all drones.
struct Look {
    std::vector<hive::StatusAnswer> answers{};
    std::chrono::steady_clock::time_point at{};
};

/// The history of one drone over the last minutes.
struct Past {
    struct Sample {
        double per_s = 0;         ///< events, of the inputs or else of the outputs
        double busy_percent = 0;  ///< of the time
    };
    static constexpr std::size_t samples_kept = 180, exceptions_kept = 8;

    std::deque<Sample> samples{};
    std::deque<hive::ExceptionStatus> exceptions{};  ///< newest first
};

/// Immutable.
struct Snapshot {
    std::uint64_t version = 0;
    std::string text{};  ///< the JSON of the whole swarm, for all pages
    Look look{};
    hive::Json drones{}, edges{};                       ///< as in the text: arrays of rows
    std::map<std::string, hive::Json> audit{}, both{};  ///< by id of the connection: the audit row, and all counters
    std::map<std::string, Past> past{};                 ///< by drone
};

/// Fills in all except version, past and text.
/// @param looks  the last three, oldest first; three times the same while there is only one
Snapshot snapshot_of(const std::array<Look, 3>& looks, const hive::SwarmGraph& graph);
/// Adds the last statuses, and removes drones that are no longer on the page.
void remember(std::map<std::string, Past>& past, const Snapshot& now);

/// The top bar: the verdict of audit in a sentence, and the machines.
hive::Json bar_of(const std::array<Look, 3>& looks);

/// Everything of one drone: outputs with their types and counts, exceptions, the last minutes. Null: not known.
hive::Json drone_details(const Snapshot& snapshot, const std::string& drone);
/// Everything of one connection. Null: not known.
hive::Json edge_details(const Snapshot& snapshot, const std::string& id);

}  // namespace hivectl::dash
