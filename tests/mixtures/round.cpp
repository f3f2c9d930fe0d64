// Doing the steps of a plan, and what is left when they are done.
#include "round.hpp"
#include "picture.hpp"

#include <algorithm>

namespace hive::mixtures {

Round::Round(Plan plan, Ground& ground)
    : plan_(std::move(plan)),
      model_(plan_.topology),
      ground_(ground),
      window_(plan_.topology.demand),
      pace_(ground.pace()),
      sizes_(plan_.topology,
             std::ssize(plan_.steps)
                 * static_cast<int>(plan_.faults.contains(fault::lie) || plan_.faults.contains(fault::ends)),
             ground_.max_places()),
      waits_(plan_.topology.demand),
      idle_(ground.pace())
{
    for (const auto& drone : plan_.topology.workers())
        values_.began(drone, first_setting);
    const auto edges = plan_.topology.edges();
    std::for_each(edges.rbegin(), edges.rend(), [this](const Edge& edge) { ground_.connect(edge); });
}

Played Round::play()
{
    Played played;
    for (const auto& step : plan_.steps) {
        ++played.steps;
        played.problems = one(step, &step == &plan_.steps.back());
        if (!played.problems.empty()) {
            played.picture = picture(ground_.statuses());
            return played;
        }
    }
    played.problems = ground_.end();
    return played;
}

Problems Round::one(const Step& step, bool last)
{
    problems_.clear();
    model_.before(step);
    try {
        perform(step);
        if (step.settle)
            std::ranges::move(settle(last), std::back_inserter(problems_));
        else
            look();
    } catch (const std::exception& error) {
        problems_.push_back(std::string("not done: ") + error.what());
    }
    std::ranges::move(ground_.complaints(), std::back_inserter(problems_));
    std::ranges::move(ground_.fallen(), std::back_inserter(problems_));
    listen();
    return problems_;
}

void Round::look()
{
    const auto statuses = ground_.statuses();
    end_excuses(statuses);
    std::ranges::move(watch(statuses), std::back_inserter(problems_));
}

void Round::perform(const Step& step)
{
    switch (step.verb) {
    case Verb::set_one:
    case Verb::set_all: return set(step);
    case Verb::set_twice: return set_twice(step);
    case Verb::set_and_kill: return set_and_kill(step);
    case Verb::replace:
        if (step.second == static_cast<int>(Meanwhile::set_all))
            return set_and_replace(step);
        break;
    case Verb::stop: stopped_.insert(step.drone); break;
    case Verb::start:
        if (stopped_.erase(step.drone) > 0 && step.drone != source && step.drone != watcher)
            values_.began(step.drone, first_setting);
        break;
    default: break;
    }
    ground_.perform(step);
}

/// Of all workers that can answer.
Change Round::change(int work_ms, int most_ms) const
{
    Change change{.drones = {}, .work_ms = work_ms, .most_ms = most_ms};
    const auto answering = ground_.answering();
    for (const auto& drone : plan_.topology.workers())
        if (std::ranges::count(answering, drone) > 0)
            change.drones.push_back(drone);
    return change;
}

void Round::set(const Step& step)
{
    auto all = change(step.number, step.second);
    if (step.verb == Verb::set_one)
        all = {.drones = {step.drone}, .work_ms = step.number, .most_ms = {}};
    if (auto problem = values_.set(all, ground_.set(all)))
        problems_.push_back(*problem);
}

void Round::set_twice(const Step& step)
{
    const auto one = change(step.number, step.second), other = change(13 - step.number, 26 - step.second);
    Told told{}, told_other{};
    ground_.at_once([&] { told = ground_.set(one); }, [&] { told_other = ground_.set(other); });
    values_.set_both(one, told, other, told_other);
}

void Round::set_and_kill(const Step& step)
{
    const auto all = change(step.number, step.second);
    Told told{};
    const auto kill = [&] {
        ground_.sleep(std::chrono::microseconds(250 * step.number));  // the kill may come anywhere in it
        ground_.perform({.verb = Verb::kill, .drone = step.drone});
    };
    ground_.at_once([&] { told = ground_.set(all); }, kill);
    if (auto problem = values_.set(all, told, step.drone))
        problems_.push_back(*problem);
}

/// What is confirmed holds for the new process too. A set that meets none of the two is refused.
void Round::set_and_replace(const Step& step)
{
    const auto all = change(step.number, 20);
    Told told{};
    const auto set = [&] {
        ground_.sleep(std::chrono::microseconds(250 * step.number));  // the new process is getting ready
        told = ground_.set(all);
    };
    ground_.at_once(set, [&] { ground_.perform(step); });
    if (auto problem = values_.set(all, told == Told::applied ? told : Told::unknown))
        problems_.push_back(*problem);
}

void Round::listen()
{
    for (const auto& outcome : ground_.outcomes())
        if (auto problem = model_.came(outcome))
            problems_.push_back(*problem);
}

}  // namespace hive::mixtures
