// Bounds what the user thread has emitted on one output and the network side has not yet seen.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>

namespace hive::service {

/// The user thread enters, the network side leaves.
class Handover {
public:
    static constexpr int most = 64;  ///< events

    /// Waits while there are too many.
    void enter();
    void leave();
    [[nodiscard]] bool empty() const noexcept { return count_ == 0; }

private:
    std::mutex mutex_;
    std::condition_variable less_;
    std::atomic<int> count_{0};
};

}  // namespace hive::service
