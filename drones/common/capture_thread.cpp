// Starts and stops the thread.
#include "capture_thread.hpp"

namespace capture {
namespace {

constexpr std::chrono::milliseconds end_within{500};

}  // namespace

bool Work::is_stopping() const
{
    const std::lock_guard lock(mutex_);
    return stopping_;
}

bool Work::wait_until(Clock::time_point when)
{
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, when, [&] { return stopping_; });
    return !stopping_;
}

void Work::notify()
{
    if (!stopping_)
        notice_();
}

void Work::run_to_the_end()
{
    run();
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
}

CaptureThread::CaptureThread(std::shared_ptr<Work> work)
    : work_(std::move(work)), thread_([shared = work_] { shared->run_to_the_end(); })
{
}

CaptureThread::~CaptureThread()
{
    std::unique_lock lock(work_->mutex_);
    work_->stopping_ = true;
    work_->changed_.notify_all();
    const bool ended = work_->changed_.wait_for(lock, end_within, [&] { return work_->ended_; });
    lock.unlock();
    if (ended)
        thread_.join();
    else
        thread_.detach();
}

}  // namespace capture
