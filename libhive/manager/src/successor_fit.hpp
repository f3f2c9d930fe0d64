// Checks that a drone of another build or kind can replace a running one.
#pragma once

#include <hive/application.hpp>

namespace hive {

/// The running drone that is to be replaced.
struct Predecessor {
    Interface interface;
    Status status;
    Json parameters;  ///< that were set
};

/// The new drone must have every connected port with a matching type, and every parameter that was set, with the value
/// in its range. Throws Errc::type_mismatch or Errc::refused. Other drones are queried only if types differ.
void require_fit(Application& application, const Predecessor& before, const Interface& next);

}  // namespace hive
