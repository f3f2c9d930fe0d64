// A world in one thread: its time, randomness, processes and their waits. Everything depends only on the seed.
#pragma once

#include "fiber.hpp"

#include <hive/platform/clock.hpp>

#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/post.hpp>

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <system_error>
#include <vector>

namespace hive::simulation {

using Time = platform::SteadyClock::time_point;
using Duration = std::chrono::nanoseconds;

/// By the wall clock.
inline constexpr std::chrono::seconds when_it_began(1'700'000'000);

/// Thrown by every call to the world in a killed process, to unwind its code.
struct Killed {};

/// The offset of a machine's clock from the time of the world.
struct MachineClock {
    Duration offset{};
    std::int64_t drift_ppm = 0;
};

class NetworkSide;
class Pipe;
class Process;

/// A thread of a process.
class Thread {
public:
    Thread(Process& process, std::function<void()> main);

    Process& process;
    Fiber fiber;
    bool runnable = true;
    std::uint64_t waits = 0;                           ///< counts its waits, so that an old alarm has no effect
    const std::function<bool()>* condition = nullptr;  ///< of the present wait; null: only its alarm ends it
};

/// A pending operation of an io_context. It counts as work until it is finished; if the context ends first, it never
/// is.
class Operation {
public:
    using Handler = std::function<void(std::error_code, std::size_t)>;

    /// Calls the handler from the context, once. Again: nothing.
    void finish(std::error_code error, std::size_t bytes = 0);

private:
    friend class NetworkSide;
    NetworkSide* side_ = nullptr;
    std::list<std::shared_ptr<Operation>>::iterator row_;  ///< there
    Handler handler_;
    std::optional<asio::executor_work_guard<asio::io_context::executor_type>> work_;
};

/// The io_context of a module, and its waiting threads.
class NetworkSide {
public:
    explicit NetworkSide(asio::io_context& context);
    ~NetworkSide();
    NetworkSide(const NetworkSide&) = delete;
    NetworkSide& operator=(const NetworkSide&) = delete;
    /// Of this context.
    static NetworkSide& of(asio::io_context& context);

    std::shared_ptr<Operation> begin(Operation::Handler handler);
    template <class Handler>
    void post(Handler handler)
    {
        ready = true;
        asio::post(context, std::move(handler));
    }

    asio::io_context& context;
    Process& process;
    bool started = false;
    int turns = 0;       ///< how often a thread has taken the turn
    bool ready = false;  ///< its context may have a handler to run
    std::vector<Thread*> waiting;

private:
    friend class Operation;
    std::list<std::shared_ptr<Operation>> operations_;
};

class Process {
public:
    Process(std::string its_name, std::int64_t its_pid) : name(std::move(its_name)), pid(its_pid) {}

    const std::string name;
    const std::int64_t pid;
    std::string failure;  ///< what its code threw
    int status = 0;       ///< once it is dead, as of waitpid
    bool dead = false, frozen = false;
    std::optional<int> writes_left;  ///< to streams and files; with the next one it dies
    std::optional<Time> busy_since;  ///< a callback takes time; the network side has a thread after 1 ms of that
    std::vector<std::unique_ptr<Thread>> threads;
    struct Connection {
        int end;  ///< that is here
        std::weak_ptr<Pipe> pipe;
        Process* peer;
    };
    std::vector<Connection> connections;
    std::map<std::int64_t, Time> unheard;  ///< by the pid of a process that gets nothing from here until then
    int machine = 0;                       ///< two on different ones have different clocks
    using Said = std::function<std::string(const std::string&)>;
    std::function<void(const std::string& line)> log = {};  ///< of the program that it runs
    std::function<Said()> said = {};  ///< per connection, a filter of the bytes sent from here; empty: all arrive
};

class World {
public:
    explicit World(std::uint64_t seed);
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    // --- time and chance ---
    [[nodiscard]] Time now() const { return now_; }
    [[nodiscard]] Duration age() const { return now_ - begin_; }
    /// Between the time of day and the age of this world.
    [[nodiscard]] Duration time_of_day() const { return time_of_day_; }
    void set_time_of_day(Duration since_begin) { time_of_day_ = since_begin; }
    /// Machine 0 has the time of day.
    void set_clock(int machine, MachineClock clock) { clocks_[machine] = clock; }
    /// Since this world began, as the clock of that machine shows it.
    [[nodiscard]] Duration wall_clock(int machine);
    /// When it showed that, unless it was set since.
    [[nodiscard]] Duration age_at(int machine, Duration wall_clock);
    std::uint64_t chance_of(std::uint64_t several) { return random_() % several; }
    bool chance(int percent) { return chance_of(100) < static_cast<std::uint64_t>(percent); }
    Duration between(Duration least, Duration most);
    std::uint64_t entropy() { return random_(); }
    void at(Time time, std::function<void()> what);
    /// Worlds with equal histories have equal digests.
    void note(std::uint64_t what) { digest_ = (digest_ ^ what) * 1'099'511'628'211U; }
    void note(std::string_view text);
    [[nodiscard]] std::uint64_t digest() const { return digest_; }
    [[nodiscard]] std::uint64_t handlers() const { return handlers_; }

    // --- processes ---
    Process& spawn(std::string name, std::function<void()> main);
    /// Stops the process: only the destructors on its stacks still run, without access to the world.
    void kill(Process& process);
    /// The same, as soon as what runs now has to wait.
    void kill(std::int64_t pid);
    /// Called before each write. @return false if it dies before this one: its further actions are invisible
    bool may_write(Process& process);
    [[nodiscard]] bool ends(std::int64_t pid) const;
    /// Null: there was none.
    [[nodiscard]] Process* process(std::int64_t pid) const;
    [[nodiscard]] const std::vector<std::unique_ptr<Process>>& processes() const { return processes_; }
    /// Until then nothing that one machine sends arrives at the other.
    [[nodiscard]] Time parted_until(int from, int to) const
    {
        const auto found = parted_.find({from, to});
        return found == parted_.end() ? Time() : found->second;
    }
    void part(int from, int to, Time until) { parted_[{from, to}] = until; }
    /// What is running; null outside of all processes.
    [[nodiscard]] Process* current() const { return current_; }

    // --- for what runs in a process ---
    /// Waits until the condition, checked after each handler of that network side, or the deadline.
    void wait(NetworkSide* side, Time deadline, const std::function<bool()>* condition);
    void sleep(Duration time) { wait(nullptr, now_ + time, nullptr); }
    /// The code of a drone takes time.
    void spend(Duration time);
    /// Throws Killed when who runs is dead.
    void require_alive() const;

    /// One thing happens, the next. @return false when there is nothing before `limit`, which it is then
    bool step(Time limit);

private:
    friend class NetworkSide;
    struct Due {
        Time time;
        std::uint64_t number;
        std::function<void()> what;
        bool operator>(const Due& other) const
        {
            return time != other.time ? time > other.time : number > other.number;
        }
    };
    void wake(Thread& thread);
    void run(Thread& thread);
    bool run_thread();
    bool run_handler();
    void ask_waiting(NetworkSide& side);
    bool next_due(Time limit);
    void costs(Duration most);

    static constexpr Time begin_{std::chrono::seconds(1'000'000)};
    Time now_ = begin_;
    Duration time_of_day_{};
    std::map<int, MachineClock> clocks_;
    std::map<std::pair<int, int>, Time> parted_;
    std::mt19937_64 random_;
    std::vector<Due> due_;
    std::uint64_t due_number_ = 0, handlers_ = 0, digest_ = 14'695'981'039'346'656'037U;
    std::vector<std::unique_ptr<Process>> processes_;
    std::int64_t next_pid_ = 1000;
    std::vector<Thread*> runnable_;
    std::vector<NetworkSide*> sides_;
    std::map<const asio::io_context*, NetworkSide*> side_of_;
    Process* current_ = nullptr;
    Thread* thread_ = nullptr;
};

/// The one that there is.
World& world();

/// As the kernel does for a process that was killed.
void close_connections_of(Process& process);

}  // namespace hive::simulation
