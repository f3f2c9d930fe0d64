// The connections of a command line: --connect, and --expect at the sender.
#pragma once

#include <hive/interface.hpp>
#include <hive/protocol/connect_text.hpp>

#include <string>
#include <vector>

namespace hive::service {

/// Reads the arguments of --connect. Throws Errc::invalid_argument for a syntax error.
std::vector<protocol::Connect> parse_connects(const std::vector<std::string>& words);

/// The same for --expect.
std::vector<protocol::Expect> expected_from(const std::vector<std::string>& words);

/// Fills in omitted outputs. Throws Errc::not_found for an unknown output and Errc::invalid_argument if one must be
/// named.
void settle(std::vector<protocol::Expect>& expected, const Interface& interface, const std::string& self);

/// Fills in omitted inputs, and checks that this drone can be connected. Throws Errc::not_found for an unknown input,
/// Errc::invalid_argument if an input must be named, gets the same output twice, or would get the drone's own events,
/// and Errc::refused for a drone that cannot share.
void settle(std::vector<protocol::Connect>& connections, const Interface& interface, const std::string& self);

}  // namespace hive::service
