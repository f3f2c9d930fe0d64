// The thread that encodes events for receivers: neither the network side, which must answer, nor the user thread, which
// must not pay for what is skipped later.
#pragma once

#include <hive/event/clock.hpp>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace hive::event {

/// Jobs run one after the other; those of one peer in order, and of several peers each in turn, so that nobody who
/// wants much keeps the others waiting. The thread begins with the first job: most modules never need it.
class EncoderThread {
public:
    using Job = std::function<void()>;

    EncoderThread() = default;
    EncoderThread(const EncoderThread&) = delete;
    EncoderThread& operator=(const EncoderThread&) = delete;
    ~EncoderThread() { end(); }

    /// Any thread. A job must not throw.
    /// @param peer  for whom it is done
    void push(const std::string& peer, Job job);
    /// Drops the jobs that wait, and waits for the one under way. What is pushed later is dropped. Any thread but its
    /// own.
    void end();
    /// How long it has been working. Any thread.
    [[nodiscard]] std::chrono::nanoseconds worked() const;

private:
    void run();
    Job take();

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::string, std::deque<Job>> jobs_;  ///< by peer; none is empty
    std::deque<std::string> turns_;                ///< these peers, the next first
    std::chrono::nanoseconds worked_{0};           ///< with the jobs that are done
    Clock::time_point since_{};                    ///< works on a job since then; the default: on none
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace hive::event
