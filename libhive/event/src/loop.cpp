// The turn, waiting with it, and the network thread that steps in when nobody has it.
#include <hive/error.hpp>
#include <hive/event/loop.hpp>

#include <asio/post.hpp>

#include <pthread.h>
#include <signal.h>
#include <sys/timerfd.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace hive::event {
namespace {

/// Signals are for the user thread.
void block_signals()
{
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

int open_timer()
{
    const int timer = ::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC);
    if (timer < 0)
        throw Error(Errc::io, "cannot make a timer: " + std::generic_category().message(errno));
    return timer;
}

}  // namespace

Loop::Loop() : timer_(open_timer()) {}

Loop::~Loop()
{
    if (started())
        end();
    ::close(timer_);
}

void Loop::start()
{
    {
        const std::lock_guard lock(mutex_);
        arm(patience);  // for what has been posted already
    }
    thread_ = std::thread([this] { watch(); });
}

void Loop::end()
{
    take();
    work_.reset();
    alarm_.cancel();
    while (run_one()) {
    }
    leave();
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        arm(std::chrono::nanoseconds(1));
    }
    thread_.join();
}

void Loop::post(Task task) { asio::post(context_, std::move(task)); }

void Loop::perform(Task task)
{
    if (!try_take())
        return post(std::move(task));
    run_after_posted(task);
    leave();
}

void Loop::call(const Task& task)
{
    if (has_turn())
        return task();
    std::exception_ptr problem;
    take();
    run_after_posted([&] {
        try {
            task();
        } catch (...) {
            problem = std::current_exception();
        }
    });
    leave();
    if (problem)
        std::rethrow_exception(problem);
}

void Loop::serve()
{
    if (!try_take())
        return;
    run_after_posted([] {});
    leave();
}

void Loop::wait(Clock::time_point deadline, const std::function<bool()>& done)
{
    take();
    while (!done() && Clock::now() < deadline) {
        if (wanted()) {
            leave();
            take();
            continue;
        }
        set_alarm(deadline);
        disarm();
        if (!run_one())
            break;
    }
    leave();
}

/// Turns are served in order, so whoever leaves and takes again lets the others go first.
void Loop::take()
{
    std::unique_lock lock(mutex_);
    const auto mine = asked_++;
    if (mine != given_back_) {
        interrupt();
        left_.wait(lock, [&] { return mine == given_back_; });
    }
    holder_ = std::this_thread::get_id();
}

bool Loop::try_take()
{
    const std::lock_guard lock(mutex_);
    if (asked_ != given_back_)
        return false;
    ++asked_;
    holder_ = std::this_thread::get_id();
    return true;
}

void Loop::leave()
{
    const std::lock_guard lock(mutex_);
    holder_ = std::thread::id();
    left_at_ = Clock::now();
    if (++given_back_ != asked_)
        left_.notify_all();
    else if (!armed_)
        arm(patience);
}

bool Loop::wanted()
{
    const std::lock_guard lock(mutex_);
    return asked_ - given_back_ > 1;
}

void Loop::arm(std::chrono::nanoseconds after)
{
    armed_ = true;
    itimerspec due{};
    due.it_value.tv_nsec = after.count();  // less than a second
    ::timerfd_settime(timer_, 0, &due, nullptr);
}

/// Before what may be a long wait: the network thread need not wake only to see that it is not needed.
void Loop::disarm()
{
    const std::lock_guard lock(mutex_);
    if (!std::exchange(armed_, false))
        return;
    const itimerspec never{};
    ::timerfd_settime(timer_, 0, &never, nullptr);
}

bool Loop::run_one() noexcept { return context_.run_one() > 0; }

/// The io_context is first in, first out: when this task has run, so has all that was posted before it.
void Loop::run_after_posted(const Task& task)
{
    bool done = false;
    asio::post(context_, [&] {
        task();
        done = true;
    });
    while (!done && run_one()) {
    }
}

/// An earlier alarm is left as it is: that costs one look too many, now and then, and no system call for each wait.
void Loop::set_alarm(Clock::time_point deadline)
{
    if (deadline == Clock::time_point::max() || (alarm_set_ && alarm_.expiry() <= deadline))
        return;
    alarm_set_ = true;
    alarm_.expires_at(deadline);
    alarm_.async_wait([this](std::error_code problem) {
        if (!problem)
            alarm_set_ = false;
    });
}

/// The network thread.
void Loop::watch()
{
    block_signals();
    std::uint64_t expirations = 0;
    while (::read(timer_, &expirations, sizeof expirations) > 0) {
        if (take_over()) {
            while (!wanted() && run_one()) {
            }
            leave();
        }
        const std::lock_guard lock(mutex_);
        if (ending_)
            return;
    }
}

/// Takes the turn if everybody has been away for long enough.
bool Loop::take_over()
{
    const std::lock_guard lock(mutex_);
    armed_ = false;
    if (ending_ || asked_ != given_back_)
        return false;  // whoever has it arms the timer when leaving
    if (const auto away = Clock::now() - left_at_; away < patience) {
        arm(patience - away);
        return false;
    }
    ++asked_;
    holder_ = std::this_thread::get_id();
    return true;
}

}  // namespace hive::event
