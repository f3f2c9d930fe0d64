// Lets one thread at a time, the one that has the turn, run the network side of a module.
#pragma once

#include <hive/event/clock.hpp>
#include <hive/platform/timer.hpp>

#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace hive::event {

/// Links, outlets, intakes and timers are handlers of one io_context, run by the thread that has the **turn**. An idle
/// thread takes the turn and waits in the io_context itself, so that an arriving packet wakes the thread that will
/// process it. Releasing the turn wakes no thread; if none takes it within `idle_timeout`, the network thread takes it
/// and keeps it until another thread needs it.
class Loop {
public:
    using Task = std::function<void()>;
    /// How long the network side may be idle. Shorter callbacks cost no thread switch; during longer ones the network
    /// thread takes over.
    static constexpr std::chrono::milliseconds idle_timeout{1};

    Loop();
    ~Loop();
    Loop(const Loop&) = delete;
    Loop& operator=(const Loop&) = delete;

    /// Starts the network thread.
    void start();
    [[nodiscard]] bool started() const noexcept;
    /// Runs the remaining tasks until there is nothing to wait for, and ends the network thread. Once; not with the
    /// turn.
    void end();
    [[nodiscard]] asio::io_context& context() noexcept { return context_; }

    /// Called with the text of a std::exception that a handler, or a task of post or perform, has thrown. Set before
    /// start(); throws nothing.
    std::function<void(const std::string& what)> on_thrown = [](const std::string&) { std::terminate(); };

    // --- any thread; tasks run in the order of these calls ---

    /// Queues a task for the thread that has or takes the turn next.
    void post(Task task);
    /// Runs a task at once on this thread if the turn is free; posts it otherwise.
    void perform(Task task);
    /// Waits for the turn and runs a task on this thread; its exceptions are thrown here.
    void call(const Task& task);
    [[nodiscard]] bool has_turn() const noexcept;

    // --- any thread that does not have the turn ---

    /// Runs what is ready, if the turn is free.
    void serve();
    /// Runs the network side until `done` (asked with the turn, after each handler) or the deadline; time_point::max():
    /// no deadline.
    void wait(Clock::time_point deadline, const std::function<bool()>& done);
    /// Returns also when a descriptor is readable. The caller keeps the descriptors.
    void wait(Clock::time_point deadline, const std::function<bool()>& done, const std::vector<int>& descriptors);
    /// Makes a wait() of another thread check again whether it is done.
    void interrupt();

private:
    void take();
    bool try_take();
    void leave();
    [[nodiscard]] bool wanted() const;
    void arm(std::chrono::nanoseconds after);
    void disarm();
    void run(const Task& task) noexcept;
    bool run_one() noexcept;
    void run_posted();
    void run_ready();
    void set_alarm(Clock::time_point deadline);
    void watch();
    bool take_over();

    asio::io_context context_{1};
    asio::executor_work_guard<asio::io_context::executor_type> work_{context_.get_executor()};
    platform::Timer alarm_{context_};  ///< the deadline of a wait
    bool alarm_set_ = false;
    bool short_wait_ = false;  ///< the last one was: the next will probably end before the network thread wakes
    bool served_ = false;      ///< the thread that has the turn has run the io_context
    std::atomic<std::thread::id> holder_{};
    std::mutex mutex_;
    std::condition_variable left_;
    std::atomic<std::uint64_t> asked_ = 0,
                               given_back_ = 0;  ///< turns, served in order; the difference: holder, waiting threads
    std::vector<Task> posted_;
    Clock::time_point served_at_{};    ///< when a thread that had run the io_context released the turn
    const int timer_;                  ///< timerfd that wakes the network thread
    std::atomic<bool> armed_ = false;  ///< the timer is set
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace hive::event
