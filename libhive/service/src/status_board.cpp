// The state of a drone, under one mutex.
#include "status_board.hpp"

#include <hive/printable.hpp>

namespace hive::service {

StatusBoard::Values StatusBoard::values() const
{
    const std::lock_guard lock(mutex_);
    return values_;
}

void StatusBoard::idle()
{
    const std::lock_guard lock(mutex_);
    values_.state = State::idle;
}

void StatusBoard::halt(const std::string& by)
{
    const std::lock_guard lock(mutex_);
    if (!halted_.exchange(true))
        values_.halted = {by, event::wall_us()};
    if (values_.state == State::idle)
        values_.state = State::halted;
}

void StatusBoard::resume()
{
    const std::lock_guard lock(mutex_);
    halted_ = false;
    values_.halted.reset();
    values_.state = State::idle;
}

bool StatusBoard::stop() { return !stopping_.exchange(true); }

bool StatusBoard::hand_over()
{
    if (stopping_)
        return false;
    handing_over_ = true;  // before the user thread can see the stop
    return stop();
}

void StatusBoard::ended()
{
    const std::lock_guard lock(mutex_);
    values_.state = State::stopping;
}

void StatusBoard::begin_work(const std::string& callback)
{
    const std::lock_guard lock(mutex_);
    if (!latest_ || latest_->first != callback)
        latest_ = &*durations_.try_emplace(callback).first;
    values_.state = State::busy;
    values_.callback = callback;
    values_.busy_since = event::Clock::now();
}

void StatusBoard::end_work()
{
    const std::lock_guard lock(mutex_);
    const auto took = event::microseconds(event::Clock::now() - values_.busy_since);
    values_.busy_us += took;
    latest_->second.add(took);
    values_.state = halted_ ? State::halted : State::idle;
    values_.callback.clear();
}

std::int64_t StatusBoard::work_p99_us(const std::string& callback) const
{
    const std::lock_guard lock(mutex_);
    const auto found = durations_.find(callback);
    return found == durations_.end() ? 0 : found->second.p99_us();
}

void StatusBoard::prepared(bool yes)
{
    const std::lock_guard lock(mutex_);
    values_.prepared = yes;
}

void StatusBoard::matched(std::size_t matching, MatchCounts counts)
{
    const std::lock_guard lock(mutex_);
    if (values_.matched.size() <= matching)
        values_.matched.resize(matching + 1);
    values_.matched[matching] = std::move(counts);
}

bool StatusBoard::condition(const std::string& text, Reason why)
{
    const std::lock_guard lock(mutex_);
    values_.why = why;
    auto kept = shortened(text);
    std::swap(values_.condition, kept);
    return values_.condition != kept;
}

void StatusBoard::source_events(std::int64_t events)
{
    const std::lock_guard lock(mutex_);
    values_.source_events = events;
}

void StatusBoard::exception(ExceptionStatus exception)
{
    const std::lock_guard lock(mutex_);
    values_.last_exception = std::move(exception);
}

ExceptionPolicy StatusBoard::policy() const
{
    const std::lock_guard lock(mutex_);
    return values_.policy;
}

void StatusBoard::policy(ExceptionPolicy policy)
{
    const std::lock_guard lock(mutex_);
    values_.policy = policy;
}

void StatusBoard::swarm(std::string name)
{
    const std::lock_guard lock(mutex_);
    values_.swarm = std::move(name);
}

}  // namespace hive::service
