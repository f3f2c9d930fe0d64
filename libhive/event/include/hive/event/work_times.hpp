// Measures the work of a group, for its leases.
#pragma once

#include <hive/event/clock.hpp>

#include <array>

namespace hive::event {

class WorkTimes {
public:
    void add(Clock::duration time) { recent_[count_++ % recent_.size()] = time; }
    [[nodiscard]] Clock::duration lease() const;

private:
    std::array<Clock::duration, 64> recent_{};
    std::size_t count_ = 0;
};

}  // namespace hive::event
