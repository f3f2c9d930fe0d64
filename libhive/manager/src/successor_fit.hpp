// Can a drone of another build, or of another kind, stand where one runs?
#pragma once

#include <hive/application.hpp>

namespace hive {

/// What runs and is to be replaced.
struct Predecessor {
    Interface interface;
    Status status;
    Json parameters;  ///< that it was told
};

/// Everything that is connected must be there with a type that fits, and everything that was set must be there and be
/// within its range. Throws Errc::type_mismatch or Errc::refused. Other drones are asked only where types differ.
void require_fit(Application& application, const Predecessor& before, const Interface& next);

}  // namespace hive
