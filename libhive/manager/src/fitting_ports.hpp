// Which ports of two drones are connected, when one or both are not named.
#pragma once

#include <hive/application.hpp>

#include <utility>

namespace hive {

/// The one pair of an output and an input that fits. Throws Errc::not_found when a port is not there,
/// Errc::type_mismatch when none fits, Errc::invalid_argument when several do.
std::pair<const Port*, const Port*> fitting_ports(const Endpoint& sender, const Interface& from,
                                                  const Endpoint& receiver, const Interface& to);

/// A drone that keeps state between events is to share them.
Error sharing_refused(const std::string& drone);

}  // namespace hive
