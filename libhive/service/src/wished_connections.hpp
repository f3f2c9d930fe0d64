// The connections that a command line asks for: --connect, and --expect at the other end.
#pragma once

#include <hive/interface.hpp>
#include <hive/protocol/connect_text.hpp>

#include <string>
#include <vector>

namespace hive::service {

/// Reads the words of --connect. Throws Errc::invalid_argument for a mistake of form.
std::vector<protocol::Connect> connections_from(const std::vector<std::string>& words);

/// The same for --expect.
std::vector<protocol::Expect> expected_from(const std::vector<std::string>& words);

/// Fills in the outputs that were left out. Throws Errc::not_found for an unknown output and Errc::invalid_argument
/// where one must be named.
void settle(std::vector<protocol::Expect>& expected, const Interface& interface, const std::string& self);

/// Fills in the inputs that were left out, and makes sure that this drone can be connected so. Throws Errc::not_found
/// for an unknown input, Errc::invalid_argument where one must be named, is given the same output twice, or would take
/// the drone's own events, and Errc::refused for a drone that cannot share.
void settle(std::vector<protocol::Connect>& connections, const Interface& interface, const std::string& self);

}  // namespace hive::service
