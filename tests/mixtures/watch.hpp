// What must hold from one look at the statuses to the next, however little time has passed.
#pragma once

#include "checks.hpp"

namespace hive::mixtures {

class Watch {
public:
    /// monotone: no counter of a registration goes back.
    Problems look(const Statuses& statuses);

private:
    Statuses before_;
};

}  // namespace hive::mixtures
