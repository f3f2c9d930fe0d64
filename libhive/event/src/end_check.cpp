// Asks in rounds with a time limit.
#include <hive/event/end_check.hpp>
#include <hive/event/intake.hpp>

#include <algorithm>
#include <utility>

namespace hive::event {

void EndCheck::begin(std::chrono::milliseconds within, Then then)
{
    waiting_.push_back({Clock::now() + within, std::move(then)});
    if (asking_.empty())
        ask();
}

void EndCheck::ask()
{
    asking_ = std::exchange(waiting_, {});
    const auto until = std::ranges::max(asking_, {}, &Question::until).until;
    const auto left = std::chrono::floor<std::chrono::milliseconds>(until - Clock::now());
    asked_ = intakes_;
    std::erase_if(asked_, [&](const auto& intake) { return !intake->ended() || left.count() <= 0; });
    for (const auto& intake : asked_)
        intake->ask_end(left);
    if (!asked_.empty())
        timer_.run_after(left, [this, round = ++round_] {
            if (round != round_)
                return;
            asked_.clear();
            look();
        });
    look();
}

void EndCheck::look()
{
    if (asking_.empty() || std::ranges::any_of(asked_, &Intake::unsure))
        return;
    stop();
    asked_.clear();
    for (const auto& question : std::exchange(asking_, {}))
        question.then();
    if (asking_.empty() && !waiting_.empty())
        ask();
}

void EndCheck::stop()
{
    ++round_;
    timer_.cancel();
}

}  // namespace hive::event
