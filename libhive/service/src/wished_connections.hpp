// The connections that a command line asks for: --connect.
#pragma once

#include <hive/interface.hpp>
#include <hive/protocol/requests.hpp>

#include <string>
#include <vector>

namespace hive::service {

/// Reads the words of --connect. Throws Errc::invalid_argument for a mistake of form.
std::vector<protocol::Connect> connections_from(const std::vector<std::string>& words);

/// Fills in the inputs that were left out, and makes sure that this drone can be connected so. Throws Errc::not_found
/// for an unknown input, Errc::invalid_argument where one must be named, is given the same output twice, or would take
/// the drone's own events, and Errc::refused for a drone that cannot share.
void settle(std::vector<protocol::Connect>& connections, const Interface& interface, const std::string& self);

}  // namespace hive::service
