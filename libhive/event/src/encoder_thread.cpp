// Runs jobs from one queue per peer.
#include <hive/event/encoder_thread.hpp>
#include <hive/platform/crash_signals.hpp>

#include <utility>

namespace hive::event {

void EncoderThread::push(const std::string& peer, Job job)
{
    const std::lock_guard lock(mutex_);
    if (ending_)
        return;
    auto& jobs = jobs_[peer];
    if (jobs.empty())
        turns_.push_back(peer);
    jobs.push_back(std::move(job));
    if (!thread_.joinable())
        thread_ = std::thread([this] { run(); });
    changed_.notify_one();
}

void EncoderThread::end()
{
    std::map<std::string, std::deque<Job>> dropped;
    std::thread ended;
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        dropped = std::exchange(jobs_, {});
        ended = std::exchange(thread_, {});
        changed_.notify_one();
    }
    dropped.clear();  // without the lock, since destroying a job may run code
    if (ended.joinable())
        ended.join();
}

std::chrono::nanoseconds EncoderThread::worked() const
{
    const std::lock_guard lock(mutex_);
    return worked_ + (since_ == Clock::time_point{} ? std::chrono::nanoseconds(0) : Clock::now() - since_);
}

/// With the mutex held.
EncoderThread::Job EncoderThread::take()
{
    const auto peer = std::move(turns_.front());
    turns_.pop_front();
    const auto row = jobs_.find(peer);
    Job job = std::move(row->second.front());
    row->second.pop_front();
    if (row->second.empty())
        jobs_.erase(row);
    else
        turns_.push_back(peer);
    return job;
}

void EncoderThread::run()
{
    const platform::CrashStack crash_stack;
    for (;;) {
        Job job;
        {
            std::unique_lock lock(mutex_);
            worked_ += since_ == Clock::time_point{} ? std::chrono::nanoseconds(0) : Clock::now() - since_;
            since_ = {};
            changed_.wait(lock, [&] { return ending_ || !jobs_.empty(); });
            if (ending_)
                return;
            job = take();
            since_ = Clock::now();
        }
        job();
    }
}

}  // namespace hive::event
