// Runs the next step: a handler, a thread, or a due timer.
#include "world.hpp"

#include <hive/error.hpp>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <exception>
#include <functional>
#include <utility>

namespace hive::simulation {

using namespace std::chrono_literals;

namespace {

World* the_world = nullptr;

/// How long the network side of a module waits before its own thread runs it (event::Loop::idle_timeout).
constexpr auto idle_timeout = 1ms;

}  // namespace

World& world() { return *the_world; }

// --- operations and network sides ---

void Operation::finish(std::error_code error, std::size_t bytes)
{
    auto* const side = std::exchange(side_, nullptr);
    if (!side)
        return;
    const auto keep = *row_;
    side->operations_.erase(row_);
    side->post([handler = std::move(handler_), error, bytes] { handler(error, bytes); });
    handler_ = nullptr;
    work_.reset();
}

NetworkSide::NetworkSide(asio::io_context& its_context) : context(its_context), process(*world().current())
{
    world().sides_.push_back(this);
    world().side_of_[&context] = this;
}

NetworkSide::~NetworkSide()
{
    while (!operations_.empty()) {  // destroying a handler may start or finish another operation
        const auto ending = std::exchange(operations_, {});
        for (const auto& operation : ending)
            operation->side_ = nullptr;
        for (const auto& operation : ending) {
            operation->work_.reset();
            operation->handler_ = nullptr;
        }
    }
    std::erase(world().sides_, this);
    world().side_of_.erase(&context);
}

NetworkSide& NetworkSide::of(asio::io_context& context) { return *world().side_of_.at(&context); }

std::shared_ptr<Operation> NetworkSide::begin(Operation::Handler handler)
{
    auto operation = std::make_shared<Operation>();
    operation->side_ = this;
    operation->handler_ = std::move(handler);
    operation->work_.emplace(context.get_executor());
    operation->row_ = operations_.insert(operations_.end(), operation);
    return operation;
}

// --- threads ---

Thread::Thread(Process& its_process, std::function<void()> main)
    : process(its_process), fiber([&its_process, main = std::move(main)] {
          try {
              if (!its_process.dead)
                  main();
          } catch (const Killed&) {
          } catch (...) {
              const auto error = current_error();
              its_process.failure = error.what();
              its_process.status = info(error.code()).exit_code << 8;
          }
          its_process.dead = true;
      })
{
}

World::World(std::uint64_t seed) : random_(seed) { the_world = this; }

World::~World()
{
    for (const auto& process : processes_)
        kill(*process);
    the_world = nullptr;
}

Process& World::spawn(std::string name, std::function<void()> main)
{
    auto& process = *processes_.emplace_back(std::make_unique<Process>(std::move(name), next_pid_++));
    runnable_.push_back(process.threads.emplace_back(std::make_unique<Thread>(process, std::move(main))).get());
    return process;
}

void World::kill(std::int64_t pid)
{
    at(now_, [this, pid] {
        if (auto* const found = process(pid))
            kill(*found);
    });
}

void World::kill(Process& process)
{
    if (process.dead)
        return;
    note(static_cast<std::uint64_t>(process.pid) * 31);
    process.dead = true;
    process.status = SIGKILL;
    process.frozen = false;
    close_connections_of(process);
    for (const auto& thread : process.threads)
        while (!thread->fiber.ended()) {
            std::erase(runnable_, thread.get());
            run(*thread);
        }
}

bool World::may_write(Process& process)
{
    if (process.dead)
        return false;
    if (!process.writes_left || *process.writes_left > 0) {
        if (process.writes_left)
            --*process.writes_left;
        return true;
    }
    if (!std::exchange(process.frozen, true)) {
        close_connections_of(process);
        kill(process.pid);
    }
    return false;
}

Process* World::process(std::int64_t pid) const
{
    const auto found = std::ranges::find(processes_, pid, [](const auto& process) { return process->pid; });
    return found == processes_.end() ? nullptr : found->get();
}

bool World::ends(std::int64_t pid) const
{
    const auto* const found = process(pid);
    return !found || found->dead;
}

void World::wake(Thread& thread)
{
    if (thread.runnable || thread.fiber.ended())
        return;
    thread.runnable = true;
    runnable_.push_back(&thread);
}

void World::run(Thread& thread)
{
    thread.runnable = false;
    auto* const process_before = std::exchange(current_, &thread.process);
    auto* const thread_before = std::exchange(thread_, &thread);
    thread.fiber.enter();
    thread_ = thread_before;
    current_ = process_before;
}

void World::require_alive() const
{
    if (current_ && current_->dead && std::uncaught_exceptions() == 0)
        throw Killed();
}

void World::wait(NetworkSide* side, Time deadline, const std::function<bool()>* condition)
{
    require_alive();
    if (!thread_ || thread_->process.dead)
        return;
    Thread& thread = *thread_;
    const auto mine = ++thread.waits;
    thread.condition = condition;
    if (side)
        side->waiting.push_back(&thread);
    if (deadline != Time::max())
        at(deadline, [this, &thread, mine] {
            if (thread.waits == mine)
                wake(thread);
        });
    thread.fiber.leave();
    ++thread.waits;
    if (side)
        std::erase(side->waiting, &thread);
    require_alive();
}

void World::spend(Duration time)
{
    Process& process = *current_;
    process.busy_since = now_;
    at(now_ + idle_timeout, [] {});
    sleep(time);  // a process killed meanwhile stays busy forever
    process.busy_since.reset();
}

// --- what happens next ---

Duration World::wall_clock(int machine)
{
    const auto& clock = clocks_[machine];
    return time_of_day_ + age() + clock.offset + age() / 1'000'000 * clock.drift_ppm;
}

Duration World::age_at(int machine, Duration wall_clock)
{
    const auto& clock = clocks_[machine];
    const auto drifted = wall_clock - time_of_day_ - clock.offset;
    return drifted - drifted / 1'000'000 * clock.drift_ppm;
}

Duration World::between(Duration least, Duration most)
{
    return least + Duration(random_() % static_cast<std::uint64_t>((most - least).count() + 1));
}

void World::at(Time time, std::function<void()> what)
{
    due_.push_back({std::max(time, now_), ++due_number_, std::move(what)});
    std::ranges::push_heap(due_, std::greater());
}

void World::note(std::string_view text)
{
    for (; !text.empty(); text.remove_prefix(std::min(text.size(), sizeof(std::uint64_t)))) {
        std::uint64_t word = 0;
        std::memcpy(&word, text.data(), std::min(text.size(), sizeof(word)));
        note(word);
    }
}

/// Every step takes time, and timers that become due run in between.
void World::costs(Duration most) { now_ += between(1us, most); }

bool World::step(Time limit)
{
    const bool threads_first = !runnable_.empty() && chance(50);
    return (threads_first && run_thread()) || run_handler() || run_thread() || next_due(limit);
}

bool World::run_thread()
{
    const auto frozen = std::ranges::partition(runnable_, [](const Thread* each) { return !each->process.frozen; });
    const auto able = runnable_.size() - frozen.size();
    if (able == 0)
        return false;
    const auto chosen = runnable_.begin() + static_cast<std::ptrdiff_t>(chance_of(able));
    Thread& thread = **chosen;
    runnable_.erase(chosen);
    note(static_cast<std::uint64_t>(thread.process.pid));
    run(thread);
    costs(20us);
    return true;
}

bool World::run_handler()
{
    if (sides_.empty())
        return false;
    const auto first = chance_of(sides_.size());
    for (std::size_t i = 0; i < sides_.size(); ++i) {
        NetworkSide& side = *sides_[(first + i) % sides_.size()];
        const Process& process = side.process;
        if (!side.ready || !side.started || process.dead || process.frozen
            || (process.busy_since && now_ < *process.busy_since + idle_timeout))
            continue;
        current_ = &side.process;
        ++side.turns;
        const bool ran = side.context.poll_one() > 0;
        if (ran || side.context.stopped())
            ask_waiting(side);
        --side.turns;
        current_ = nullptr;
        side.ready = ran;
        if (!ran)
            continue;
        ++handlers_;
        costs(20us);
        return true;
    }
    return false;
}

void World::ask_waiting(NetworkSide& side)
{
    for (auto* const thread : std::vector(side.waiting))
        if (!thread->runnable && thread->condition && (*thread->condition)())
            wake(*thread);
}

bool World::next_due(Time limit)
{
    if (due_.empty() || due_.front().time > limit) {
        now_ = std::max(now_, limit);
        return false;
    }
    std::ranges::pop_heap(due_, std::greater());
    const auto due = std::move(due_.back());
    due_.pop_back();
    now_ = std::max(now_, due.time);
    note(static_cast<std::uint64_t>(now_.time_since_epoch().count()));
    due.what();
    return true;
}

}  // namespace hive::simulation
