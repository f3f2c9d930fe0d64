// A way to the network side that outlives the module.
#pragma once

#include <hive/event/loop.hpp>

#include <mutex>

namespace hive::event {

/// What is posted after the module's end is dropped. Any thread.
class Door {
public:
    explicit Door(Loop& loop) : loop_(&loop) {}
    void post(Loop::Task task);
    /// Does this thread have the turn?
    [[nodiscard]] bool inside();
    void shut();

private:
    std::mutex mutex_;
    Loop* loop_;
};

}  // namespace hive::event
