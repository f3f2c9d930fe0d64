// Drones that have to wait do nothing.
#pragma once

#include "checks.hpp"

namespace hive::mixtures {

/// waits: a drone that has halted works on nothing, and a source on demand produces nothing while a place is kept.
/// Whoever is told to go on in between must be seen before it is told to wait again.
class Waits {
public:
    /// @param lossless  whether the source produces on demand
    explicit Waits(bool lossless) : lossless_(lossless) {}

    Problems look(const Statuses& statuses);

private:
    bool lossless_;
    Statuses before_;
};

}  // namespace hive::mixtures
