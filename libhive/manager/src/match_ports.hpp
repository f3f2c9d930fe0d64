// Infers the ports of a connection if one or both are not named.
#pragma once

#include <hive/application.hpp>

#include <utility>
#include <vector>

namespace hive {

using PortPair = std::pair<const Port*, const Port*>;  ///< an output and an input

/// All pairs whose types match; empty: none does. Throws Errc::not_found if a named port does not exist, or if a drone
/// has no output or no input.
std::vector<PortPair> matching_ports(const Endpoint& sender, const Interface& from, const Endpoint& receiver,
                                     const Interface& to);
/// The only matching pair of an output and an input. Throws Errc::not_found if a named port does not exist,
/// Errc::type_mismatch if no pair matches, Errc::invalid_argument if several do.
PortPair match_ports(const Endpoint& sender, const Interface& from, const Endpoint& receiver, const Interface& to);

/// Refuses to share work with a stateful drone.
Error sharing_refused(const std::string& drone);

}  // namespace hive
