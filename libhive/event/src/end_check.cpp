// Rounds of questions with a time limit.
#include <hive/event/end_check.hpp>
#include <hive/event/intake.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace hive::event {

void EndCheck::begin(Then then)
{
    waiting_.push_back(std::move(then));
    if (asking_.empty())
        ask();
}

void EndCheck::ask()
{
    asking_ = std::exchange(waiting_, {});
    asked_ = intakes_;
    std::erase_if(asked_, [](const auto& intake) { return !intake->ended(); });
    for (const auto& intake : asked_)
        intake->ask_end();
    if (!asked_.empty())
        timer_.run_after(patience_, [this] {
            // Who waits for the next round may be who was asked: in a cycle, two drones would ask each other for ever.
            std::ranges::move(std::exchange(waiting_, {}), std::back_inserter(asking_));
            asked_.clear();
            look();
        });
    look();
}

void EndCheck::look()
{
    if (asking_.empty() || std::ranges::any_of(asked_, &Intake::unsure))
        return;
    timer_.cancel();
    asked_.clear();
    for (const auto& then : std::exchange(asking_, {}))
        then();
    if (asking_.empty() && !waiting_.empty())
        ask();
}

}  // namespace hive::event
