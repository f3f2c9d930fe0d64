// The thread that encodes events for receivers, since the network side must stay responsive, and the user thread must
// not encode events that are skipped later.
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

/// Jobs run one after the other: those of one peer in order, and the peers in turn, so that no peer with many jobs
/// delays the others. The thread starts with the first job, since most modules never need it.
class EncoderThread {
public:
    using Job = std::function<void()>;

    EncoderThread() = default;
    EncoderThread(const EncoderThread&) = delete;
    EncoderThread& operator=(const EncoderThread&) = delete;
    ~EncoderThread() { end(); }

    /// Any thread. A job must not throw.
    /// @param peer  the peer that needs it
    void push(const std::string& peer, Job job);
    /// Drops waiting jobs, and waits for the running one. Jobs pushed later are dropped. Any thread but its own.
    void end();
    /// The total time spent on jobs. Any thread.
    [[nodiscard]] std::chrono::nanoseconds worked() const;

private:
    void run();
    Job take();

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::string, std::deque<Job>> jobs_;  ///< by peer; none is empty
    std::deque<std::string> turns_;                ///< these peers, the next first
    std::chrono::nanoseconds worked_{0};           ///< on finished jobs
    Clock::time_point since_{};                    ///< start of the running job; the default: none
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace hive::event
