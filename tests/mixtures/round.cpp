// Doing the steps of a plan, and what is left when they are done.
#include "round.hpp"
#include "picture.hpp"

#include <future>

namespace hive::mixtures {
namespace {

using namespace std::chrono_literals;

/// Descriptors and mappings of shared memory of this process itself.
std::size_t held_here()
{
    const auto maps = test::text_of("/proc/self/maps");
    std::size_t mapped = 0;
    for (auto at = maps.find("memfd:"); at != std::string::npos; at = maps.find("memfd:", at + 1))
        ++mapped;
    return test::open_descriptors(::getpid()) + mapped;
}

}  // namespace

Round::Round(Plan plan)
    : plan_(std::move(plan)),
      model_(plan_.topology),
      running_(plan_.topology),
      collecting_(running_.swarm(), plan_.topology)
{
    for (const auto& drone : plan_.topology.workers())
        values_.began(drone, Running::first_setting());
    const auto edges = plan_.topology.edges();
    std::for_each(edges.rbegin(), edges.rend(), [this](const Edge& edge) { running_.connect(edge); });
}

Played Round::play()
{
    Played played;
    for (const auto& step : plan_.steps) {
        ++played.steps;
        played.problems = one(step, &step == &plan_.steps.back());
        if (!played.problems.empty()) {
            played.picture = picture(running_.statuses());
            return played;
        }
    }
    played.problems = running_.end();
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
            end_excuses(running_.statuses());
    } catch (const std::exception& error) {
        problems_.push_back(std::string("not done: ") + error.what());
    }
    std::ranges::move(running_.fallen(), std::back_inserter(problems_));
    listen();
    return problems_;
}

void Round::perform(const Step& step)
{
    switch (step.verb) {
    case Verb::set_one:
    case Verb::set_all: return set(step);
    case Verb::set_twice: return set_twice(step);
    case Verb::set_and_kill: return set_and_kill(step);
    case Verb::stop: stopped_.insert(step.drone); break;
    case Verb::start:
        if (stopped_.erase(step.drone) > 0 && step.drone != source && step.drone != watcher)
            values_.began(step.drone, Running::first_setting());
        break;
    default: break;
    }
    running_.perform(step);
}

/// Of all workers that can answer.
Change Round::change(int work_ms, int most_ms) const
{
    Change change{.drones = {}, .work_ms = work_ms, .most_ms = most_ms};
    const auto answering = running_.answering();
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
    if (auto problem = values_.set(all, running_.set(all)))
        problems_.push_back(*problem);
}

void Round::set_twice(const Step& step)
{
    const auto one = change(step.number, step.second), other = change(13 - step.number, 26 - step.second);
    auto told = std::async(std::launch::async, [&] { return running_.set(one); });
    const auto told_other = running_.set(other);
    values_.set_both(one, told.get(), other, told_other);
}

void Round::set_and_kill(const Step& step)
{
    const auto all = change(step.number, step.second);
    auto told = std::async(std::launch::async, [&] { return running_.set(all); });
    std::this_thread::sleep_for(std::chrono::microseconds(250 * step.number));  // the kill may come anywhere in it
    running_.perform({.verb = Verb::kill, .drone = step.drone});
    if (auto problem = values_.set(all, told.get(), step.drone))
        problems_.push_back(*problem);
}

void Round::listen()
{
    for (const auto& outcome : collecting_.take())
        if (auto problem = model_.came(outcome))
            problems_.push_back(*problem);
}

Played play(const Plan& plan)
{
    const auto held = held_here();
    Played played;
    try {
        played = Round(plan).play();
    } catch (const std::exception& error) {
        played.problems = {std::string("the round did not begin or end: ") + error.what()};
    }
    if (!test::eventually([&] { return held_here() <= held; }))
        played.problems.push_back("descriptors or shared memory are left: " + std::to_string(held_here()) + ", before "
                                  + std::to_string(held));
    return played;
}

}  // namespace hive::mixtures
