// Waits for the network side and for file descriptors at once.
#pragma once

#include <hive/event/loop.hpp>

#include <functional>
#include <vector>

namespace hive::event {

/// As Loop::wait(); also returns when a descriptor is readable. The caller keeps the descriptors.
void wait(Loop& loop, Clock::time_point deadline, const std::function<bool()>& done,
          const std::vector<int>& descriptors);

}  // namespace hive::event
