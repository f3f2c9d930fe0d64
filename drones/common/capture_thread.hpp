// A thread that captures images for a drone and keeps the newest.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace capture {

/// The work of the thread, and the state shared with its owner. It outlives the owner if the thread is stuck, so it
/// owns everything that the thread needs.
class Work {
public:
    using Clock = std::chrono::steady_clock;

    /// @param notice  called from the thread when there is news; never after its CaptureThread is destroyed
    explicit Work(std::function<void()> notice) : notice_(std::move(notice)) {}
    virtual ~Work() = default;
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

protected:
    /// On the thread. Returns soon after is_stopping().
    virtual void run() = 0;

    [[nodiscard]] bool is_stopping() const;
    /// Waits; false if the thread is to end.
    bool wait_until(Clock::time_point when);
    /// Notifies the owner. The mutex is held.
    void notify();

    mutable std::mutex mutex_;         ///< for all that the thread and its owner share
    std::condition_variable changed_;  ///< also when the thread is to end
    bool stopping_ = false;

private:
    friend class CaptureThread;
    void run_to_the_end();

    std::function<void()> notice_;
    bool ended_ = false;
};

/// Work that produces images.
template <class Frame>
class FrameWork : public Work {
public:
    using Work::Work;

    /// The newest image not taken yet.
    std::optional<Frame> take()
    {
        const std::lock_guard lock(mutex_);
        return std::exchange(newest_, std::nullopt);
    }

protected:
    std::optional<Frame> newest_;
};

/// For one thread (the drone's), on which it is made and destroyed.
class CaptureThread {
public:
    explicit CaptureThread(std::shared_ptr<Work> work);
    /// Waits half a second for the thread; one that is stuck is left to end by itself.
    ~CaptureThread();
    CaptureThread(const CaptureThread&) = delete;
    CaptureThread& operator=(const CaptureThread&) = delete;

private:
    std::shared_ptr<Work> work_;
    std::thread thread_;
};

}  // namespace capture
