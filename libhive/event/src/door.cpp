// Posting to a module that may have ended.
#include <hive/event/door.hpp>

namespace hive::event {

void Door::post(Loop::Task task)
{
    const std::lock_guard lock(mutex_);
    if (loop_)
        loop_->post(std::move(task));
}

bool Door::inside()
{
    const std::lock_guard lock(mutex_);
    return loop_ && loop_->has_turn();
}

void Door::shut()
{
    const std::lock_guard lock(mutex_);
    loop_ = nullptr;
}

}  // namespace hive::event
