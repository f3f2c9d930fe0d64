// The loop: a thread waits by leaving its stack, and the world runs the handlers.
#include "world.hpp"

#include <hive/event/loop.hpp>

#include <asio/post.hpp>

#include <memory>
#include <unordered_map>
#include <utility>

namespace hive::event {
namespace {

using simulation::NetworkSide;
using simulation::world;

std::unordered_map<const Loop*, std::unique_ptr<NetworkSide>>& sides()
{
    static std::unordered_map<const Loop*, std::unique_ptr<NetworkSide>> all;
    return all;
}

NetworkSide& side_of(const Loop* loop) { return *sides().at(loop); }

}  // namespace

/// Its context takes no lock: there is one thread.
Loop::Loop() : context_(ASIO_CONCURRENCY_HINT_UNSAFE), timer_(-1)
{
    sides().emplace(this, std::make_unique<NetworkSide>(context_));
}

Loop::~Loop()
{
    if (started())
        end();
    work_.reset();
    posted_.clear();
    sides().erase(this);
}

/// A module of a dead process ends by itself: it closes nothing and notifies no peer.
bool Loop::started() const noexcept { return side_of(this).started && !side_of(this).process.dead; }
bool Loop::has_turn() const noexcept { return side_of(this).turns > 0; }
void Loop::start() { side_of(this).started = true; }
void Loop::take() { ++side_of(this).turns; }
void Loop::leave()
{
    auto& side = side_of(this);
    --side.turns;
    side.ready = true;
}

void Loop::end()
{
    work_.reset();
    alarm_.cancel();
    const std::function<bool()> stopped = [this] { return context_.stopped(); };
    while (!context_.stopped() && started())
        world().wait(&side_of(this), simulation::Time::max(), &stopped);
    side_of(this).started = false;
}

void Loop::post(Task task)
{
    if (side_of(this).process.dead)
        return;
    posted_.push_back(std::move(task));
    if (posted_.size() == 1)
        side_of(this).post([this] { run_posted(); });
}

/// Sometimes another thread has the turn. Destructors call this, so it throws nothing.
void Loop::perform(Task task)
{
    if (side_of(this).process.dead || has_turn() || world().chance(20))
        return post(std::move(task));
    take();
    run_posted();
    run(task);
    leave();
}

void Loop::call(const Task& task)
{
    if (has_turn())
        return task();
    world().require_alive();
    if (side_of(this).process.dead)
        return;
    take();
    run_posted();
    try {
        task();
    } catch (...) {
        leave();
        throw;
    }
    leave();
}

void Loop::serve()
{
    world().require_alive();
    if (side_of(this).process.dead)
        return;
    take();
    run_ready();
    leave();
}

void Loop::wait(Clock::time_point deadline, const std::function<bool()>& done)
{
    world().require_alive();
    if (side_of(this).process.dead)
        return;
    take();
    const bool over = done() || Clock::now() >= deadline;
    if (over)
        run_ready();
    leave();
    if (!over)
        world().wait(&side_of(this), deadline, &done);
}

/// Descriptors report nothing: those who watch them poll as well.
void Loop::wait(Clock::time_point deadline, const std::function<bool()>& done, const std::vector<int>&)
{
    wait(deadline, done);
}

void Loop::interrupt()
{
    side_of(this).post([] {});
}

void Loop::run(const Task& task) noexcept { task(); }

bool Loop::run_one() noexcept { return context_.run_one() > 0; }

void Loop::run_posted()
{
    for (const auto& task : std::exchange(posted_, {}))
        run(task);
}

void Loop::run_ready()
{
    bool done = false;
    asio::post(context_, [&] { done = true; });
    while (!done && run_one()) {
    }
}

}  // namespace hive::event
