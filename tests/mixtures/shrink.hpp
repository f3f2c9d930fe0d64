// Makes a round that fails shorter.
#pragma once

#include "plan.hpp"

#include <functional>

namespace hive::mixtures {

/// Leaves out steps as long as the round still fails. What is broken is mended at its end as before.
Plan shrunk(Plan plan, const std::function<bool(const Plan&)>& fails);

}  // namespace hive::mixtures
