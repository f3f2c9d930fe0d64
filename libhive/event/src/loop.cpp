// The turn, waits with the turn, and the network thread, which takes over when no thread has it.
#include <hive/error.hpp>
#include <hive/event/loop.hpp>
#include <hive/platform/crash_signals.hpp>

#include <asio/posix/stream_descriptor.hpp>
#include <asio/post.hpp>

#include <list>
#include <memory>
#include <pthread.h>
#include <signal.h>
#include <sys/timerfd.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace hive::event {
namespace {

/// Blocks signals, which are for the user thread.
void block_signals()
{
    const auto others = platform::signals_for_others();
    ::pthread_sigmask(SIG_BLOCK, &others, nullptr);
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

bool Loop::started() const noexcept { return thread_.joinable(); }
bool Loop::has_turn() const noexcept { return holder_ == std::this_thread::get_id(); }

void Loop::start()
{
    {
        const std::lock_guard lock(mutex_);
        arm(idle_timeout);  // for tasks that are already posted
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

void Loop::post(Task task)
{
    bool first = false;
    {
        const std::lock_guard lock(mutex_);
        first = posted_.empty();
        posted_.push_back(std::move(task));
    }
    if (first)
        asio::post(context_, [this] { run_posted(); });
}

/// Does not poll the io_context: reads and completed writes are left to the next wait() or serve().
void Loop::perform(Task task)
{
    if (!try_take())
        return post(std::move(task));
    run_posted();
    run(task);
    leave();
}

void Loop::call(const Task& task)
{
    if (has_turn())
        return task();
    std::exception_ptr problem;
    take();
    run_posted();
    try {
        task();
    } catch (...) {
        problem = std::current_exception();
    }
    leave();
    if (problem)
        std::rethrow_exception(problem);
}

void Loop::serve()
{
    if (!try_take())
        return;
    run_ready();
    leave();
}

void Loop::wait(Clock::time_point deadline, const std::function<bool()>& done)
{
    take();
    bool ran = false;
    const auto begin = Clock::now();
    for (auto now = begin; !done() && now < deadline; now = Clock::now()) {
        if (wanted()) {
            leave();
            take();
            continue;
        }
        set_alarm(deadline);
        if (!short_wait_)
            disarm();
        ran = true;
        if (!run_one())
            break;
    }
    if (!ran)
        run_ready();
    short_wait_ = Clock::now() - begin
                  < idle_timeout / 4;  // then an occasional wake-up is cheaper than two system calls for each wait
    leave();
}

/// Watches the descriptors in the io_context that also receives answers, so that one wait suffices.
void Loop::wait(Clock::time_point deadline, const std::function<bool()>& done, const std::vector<int>& descriptors)
{
    using Descriptor = asio::posix::stream_descriptor;
    const auto readable = std::make_shared<bool>(false);
    std::list<Descriptor> watched;
    call([&] {
        for (const int descriptor : descriptors)
            watched.emplace_back(context_, descriptor)
                .async_wait(Descriptor::wait_read,
                            [readable](const std::error_code& error) { *readable = *readable || !error; });
    });
    wait(deadline, [&] { return *readable || done(); });
    call([&] {
        for (auto& one : watched)
            one.release();  // the caller closes it
        watched.clear();
    });
}

/// Turns are served in order, so a thread that releases and retakes the turn lets the others go first.
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
    if (std::exchange(served_, false))
        served_at_ = Clock::now();
    if (++given_back_ != asked_)
        left_.notify_all();
    else if (!armed_)
        arm(idle_timeout);
}

bool Loop::wanted() const { return asked_ - given_back_ > 1; }

void Loop::arm(std::chrono::nanoseconds after)
{
    armed_ = true;
    itimerspec due{};
    due.it_value.tv_nsec = after.count();  // less than a second
    ::timerfd_settime(timer_, 0, &due, nullptr);
}

/// Before a wait that is likely to be long, so that the network thread does not wake needlessly.
void Loop::disarm()
{
    if (!armed_)
        return;
    const std::lock_guard lock(mutex_);
    armed_ = false;
    const itimerspec never{};
    ::timerfd_settime(timer_, 0, &never, nullptr);
}

void Loop::interrupt()
{
    asio::post(context_, [] {});
}

void Loop::run(const Task& task) noexcept
try {
    task();
} catch (const std::exception& error) {
    on_thrown(error.what());
} catch (...) {
    on_thrown("no std::exception");
}

bool Loop::run_one() noexcept
try {
    served_ = true;
    return context_.run_one() > 0;
} catch (const std::exception& error) {
    on_thrown(error.what());
    return true;
} catch (...) {
    on_thrown("no std::exception");
    return true;
}

/// Runs the tasks posted so far, in the order of the calls.
void Loop::run_posted()
{
    std::vector<Task> tasks;
    {
        const std::lock_guard lock(mutex_);
        tasks.swap(posted_);
    }
    for (const auto& task : tasks)
        run(task);
}

/// The io_context is first in, first out: when this handler has run, so has all that was ready before it.
void Loop::run_ready()
{
    bool done = false;
    asio::post(context_, [&] { done = true; });
    while (!done && run_one()) {
    }
}

/// Keeps an earlier alarm: that costs an occasional needless wake-up, but no system call per wait.
void Loop::set_alarm(Clock::time_point deadline)
{
    if (deadline == Clock::time_point::max() || (alarm_set_ && alarm_.expiry() <= deadline))
        return;
    alarm_set_ = true;
    alarm_.run_at(deadline, [this] { alarm_set_ = false; });
}

/// The network thread.
void Loop::watch()
{
    block_signals();
    const platform::CrashStack crash_stack;
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

/// Takes the turn if no thread has had it for long enough.
bool Loop::take_over()
{
    const std::lock_guard lock(mutex_);
    armed_ = false;
    if (ending_ || asked_ != given_back_)
        return false;  // its holder arms the timer when releasing it
    if (const auto away = Clock::now() - served_at_; away < idle_timeout) {
        arm(idle_timeout - away);
        return false;
    }
    ++asked_;
    holder_ = std::this_thread::get_id();
    return true;
}

}  // namespace hive::event
