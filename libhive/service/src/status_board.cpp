// The state of a drone, under one mutex.
#include "status_board.hpp"

#include <hive/printable.hpp>

#include <algorithm>
#include <cmath>

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
    values_.state = State::busy;
    values_.callback = callback;
    values_.busy_since = event::Clock::now();
}

void StatusBoard::end_work()
{
    const std::lock_guard lock(mutex_);
    const auto took = event::microseconds(event::Clock::now() - values_.busy_since);
    values_.busy_us += took;
    durations_[values_.callback].add(took);
    values_.state = halted_ ? State::halted : State::idle;
    values_.callback.clear();
}

std::int64_t StatusBoard::work_p99_us(const std::string& callback) const
{
    const std::lock_guard lock(mutex_);
    const auto found = durations_.find(callback);
    return found == durations_.end() ? 0 : found->second.p99_us();
}

void StatusBoard::Durations::add(std::int64_t us)
{
    constexpr std::uint32_t remembered = 2000;
    const auto log = std::log2(static_cast<double>(std::max<std::int64_t>(us, 1)));
    ++counts_[static_cast<std::size_t>(std::clamp(static_cast<int>(log * classes_per_doubling), 0, classes - 1))];
    if (++total_ < remembered)
        return;
    total_ = 0;
    for (auto& count : counts_)
        total_ += count /= 2;
}

/// Returns the upper limit of the class that contains the 99th percentile.
std::int64_t StatusBoard::Durations::p99_us() const
{
    std::uint32_t above = 0;
    for (int i = classes; i-- > 0;)
        if (above += counts_[static_cast<std::size_t>(i)]; above > total_ / 100)
            return std::llround(std::exp2(static_cast<double>(i + 1) / classes_per_doubling));
    return 0;
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
