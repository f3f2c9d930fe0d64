// Starts drones for verbs.
#pragma once

#include <hive/start.hpp>

namespace hivectl {

class CommandLine;
class Session;

/// The options for the fields of an order.
void declare_fields(CommandLine& line, hive::DroneOrder& order);
/// Adds the timeout, cancellation and messages of a verb.
hive::StartOptions start_options(const Session& session, const std::string& verb, hive::DroneOrder drone,
                                 const std::string& on = {});
/// Starts a drone that keeps running, or replaces one, and prints its name when it is ready. Returns the exit code.
int start_in_background(Session& session, const hive::StartOptions& options,
                        hive::Started (*start)(hive::Application&, hive::StartOptions) = hive::start);
/// Starts a drone that runs as long as the verb.
hive::TiedDrone start_for_verb(Session& session, const std::string& verb, const hive::DroneOrder& drone);

}  // namespace hivectl
