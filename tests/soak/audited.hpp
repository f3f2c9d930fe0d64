// Judges what `hivectl audit --json` prints by what the swarm really did.
#pragma once

#include <checks.hpp>

#include <hive/json.hpp>

#include <map>
#include <set>
#include <string>

namespace hive::soak {

/// What is known of the swarm without its own counters.
struct Known {
    bool at_rest = false;                          ///< everything is up and connected, and nothing is in flight
    std::map<std::string, std::int64_t> failures;  ///< exceptions that drones' code threw, by drone, since its start
    std::map<std::string, std::int64_t> given_up;  ///< exceptions for events that a sender gave up, likewise
    std::set<std::pair<std::string, std::string>> connections;  ///< sender and receiver
    std::int64_t breaks = 0;  ///< so often may a drone that only watches have lost the notification under way
};

/// audit: each row adds up, no row accuses a drone of a loss that the collector has not seen, and no two ends differ.
/// At rest also: each connection has a row with both ends, nothing is in flight, and each exception is counted.
mixtures::Problems misjudged(const Json& rows, const Known& known);

}  // namespace hive::soak
