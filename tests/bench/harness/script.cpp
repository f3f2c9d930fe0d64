// The phases of a publisher.
#include "script.hpp"

#include <stdexcept>

namespace hive::bench {
namespace {

constexpr Nanoseconds probe_every = 5 * millisecond, warm_every = 4 * millisecond;
constexpr Nanoseconds settle = 50 * millisecond, breath = 20 * millisecond;
constexpr std::uint64_t warm_frames = 12, warm_credit = 4;
constexpr std::uint64_t least_measured = 8, most_stalls = 3;

Kind kind_of(int phase)
{
    constexpr Kind kinds[]{Kind::probe, Kind::warm, Kind::measured, Kind::end};
    return kinds[phase];
}

}  // namespace

Script::Script(const Run& run, int credit, Board& board)
    : run_(run),
      credit_(static_cast<std::uint64_t>(credit)),
      board_(board),
      cameras_(run.size),
      next_(now_ns()),
      give_up_(next_ + 15 * second)
{
}

std::optional<Nanoseconds> Script::due()
{
    advance();
    if (phase_ == Phase::done)
        return std::nullopt;
    if (phase_ == Phase::measuring && credit_ > 0 && !wait_for_credit(credit_, second / 2))
        ++board_.stalls;
    return next_;
}

Frame Script::next()
{
    if (phase_ == Phase::measuring && in_phase_ == 0) {
        usage_ = own_usage();
        measuring_since_ = now_ns();
    }
    const Nanoseconds paced = nanoseconds_of(1 / run_.rate);
    switch (phase_) {
    case Phase::probing: next_ = now_ns() + probe_every; break;
    case Phase::warming: next_ = run_.test == Test::latency ? next_ + warm_every : 0; break;
    case Phase::measuring: next_ = run_.test == Test::latency ? next_ + paced : 0; break;
    default: next_ = now_ns() + probe_every;
    }
    ++in_phase_;
    const bool counted = phase_ == Phase::warming || phase_ == Phase::measuring;
    const auto sequence = sequence_;
    sequence_ += counted ? 1 : 0;
    return cameras_.frame(sequence, kind_of(static_cast<int>(phase_)));
}

void Script::begin(Phase phase, Nanoseconds pause)
{
    phase_ = phase;
    in_phase_ = 0;
    next_ = now_ns() + pause;
}

void Script::advance()
{
    const auto ready = [](const Received& received) { return received.ready.load(); };
    const auto done = [](const Received& received) { return received.done.load(); };
    if (phase_ == Phase::probing && board_.all(run_.subscribers, ready))
        begin(Phase::warming, settle);
    else if (phase_ == Phase::probing && now_ns() > give_up_)
        throw std::runtime_error("the subscribers never came");
    else if (phase_ == Phase::warming && in_phase_ == warm_frames) {
        wait_for_credit(1, second);
        begin(Phase::measuring, breath);
    } else if (phase_ == Phase::warming && run_.test != Test::latency)
        wait_for_credit(warm_credit, second / 2);
    else if (phase_ == Phase::measuring && measured_enough())
        finish_measuring();
    else if (phase_ == Phase::ending && (board_.all(run_.subscribers, done) || now_ns() > give_up_))
        phase_ = Phase::done;
}

bool Script::measured_enough() const
{
    if (board_.stalls > most_stalls)
        return true;
    if (run_.test == Test::latency)
        return in_phase_ >= static_cast<std::uint64_t>(run_.frames);
    return in_phase_ >= least_measured && now_ns() - measuring_since_ >= nanoseconds_of(run_.seconds);
}

void Script::finish_measuring()
{
    wait_for_credit(1, 2 * second);
    board_.usage = own_usage() - usage_;
    board_.sent = in_phase_;
    give_up_ = now_ns() + 4 * second;
    begin(Phase::ending, 0);
}

/// Sleeps until fewer frames than the credit are under way; false when that takes too long.
bool Script::wait_for_credit(std::uint64_t credit, Nanoseconds timeout)
{
    const auto spent = [&] { return sequence_ >= board_.consumed(run_.subscribers) + credit; };
    const auto end = now_ns() + timeout;
    while (spent()) {
        const auto bell = board_.bell.load();
        board_.listening = true;
        if (spent())
            futex_wait(board_.bell, bell, 20 * millisecond);
        board_.listening = false;
        if (now_ns() > end)
            return false;
    }
    return true;
}

}  // namespace hive::bench
