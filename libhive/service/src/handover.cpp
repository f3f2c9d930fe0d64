// The way of emitted events from the user thread to the network side.
#include "handover.hpp"

namespace hive::service {

void Handover::enter()
{
    std::unique_lock lock(mutex_);
    less_.wait(lock, [&] { return count_ < most; });
    ++count_;
}

void Handover::leave()
{
    {
        const std::lock_guard lock(mutex_);
        --count_;
    }
    less_.notify_one();
}

}  // namespace hive::service
