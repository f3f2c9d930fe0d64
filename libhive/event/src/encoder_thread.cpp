// A thread with a queue of jobs.
#include <hive/event/encoder_thread.hpp>

#include <utility>

namespace hive::event {

void EncoderThread::push(Job job)
{
    const std::lock_guard lock(mutex_);
    if (ending_)
        return;
    jobs_.push_back(std::move(job));
    if (!thread_.joinable())
        thread_ = std::thread([this] { run(); });
    changed_.notify_one();
}

void EncoderThread::end()
{
    std::deque<Job> dropped;
    std::thread ended;
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        dropped = std::exchange(jobs_, {});
        ended = std::exchange(thread_, {});
        changed_.notify_one();
    }
    dropped.clear();  // without the lock: what a job holds may have work to do
    if (ended.joinable())
        ended.join();
}

void EncoderThread::run()
{
    for (;;) {
        Job job;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return ending_ || !jobs_.empty(); });
            if (ending_)
                return;
            job = std::move(jobs_.front());
            jobs_.pop_front();
        }
        job();
    }
}

}  // namespace hive::event
