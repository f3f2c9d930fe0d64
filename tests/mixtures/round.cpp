// Doing the steps of a plan, and what is left when they are done.
#include "round.hpp"
#include "picture.hpp"

#include <algorithm>

namespace hive::mixtures {

Round::Round(Plan plan, Ground& ground)
    : plan_(std::move(plan)),
      model_(plan_.topology, ground.collectors()),
      ground_(ground),
      window_(plan_.topology.demand),
      pace_(ground.pace()),
      sizes_(plan_.topology,
             std::ssize(plan_.steps)
                     * static_cast<int>(plan_.faults.contains(fault::lie) || plan_.faults.contains(fault::ends))
                 + ground.collectors() - 1,
             ground_.max_places()),
      waits_(plan_.topology.demand),
      idle_(ground.pace()),
      fates_(
          plan_.topology, [&ground](const auto& drone, const auto& peer) { return ground.was_cut(drone, peer); },
          !ground.punctual() || plan_.faults.contains(fault::silence))
{
    for (const auto& drone : plan_.topology.workers())
        values_.began(drone, first_setting);
    if (ground_.begin(plan_.topology.edges()))
        for (const auto& drone : model_.excused())
            model_.whole(drone, 0, 0);
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
    const auto run = last_run();
    played.problems = wrongly_printed(run);
    if (!played.problems.empty())
        played.picture = picture(ground_.statuses());
    const auto add = [&](const Problems& more) { std::ranges::copy(more, std::back_inserter(played.problems)); };
    add(ground_.end());
    for (const auto& received : ground_.received())
        add(wrongly_received(received, model_, run));
    return played;
}

LastRun Round::last_run() const
{
    const auto statuses = ground_.statuses();
    const auto found = statuses.find(source);
    if (found == statuses.end())
        return {};
    return {.epoch = found->second.epoch,
            .produced = found->second.outputs.at(0).produced,
            .lossless = plan_.topology.demand,
            .first = ground_.born().at(source) == 0};
}

Problems Round::wrongly_printed(const LastRun& run)
{
    const auto printed = ground_.end_source();
    if (!printed)
        return {};
    listen();
    return mixtures::wrongly_printed(*printed, model_, run);
}

Problems Round::one(const Step& step, bool last)
{
    problems_.clear();
    model_.before(step, ground_.now());
    fates_.before(step);
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

Statuses Round::look()
{
    auto statuses = ground_.statuses();
    end_excuses(statuses);
    std::ranges::move(watch(statuses), std::back_inserter(problems_));
    return statuses;
}

/// Looks meanwhile, and no longer than this drone works, if one is named.
void Round::wait(std::chrono::milliseconds time, const std::string& busy)
{
    for (const auto end = ground_.now() + time; ground_.now() < end;) {
        const auto statuses = look();
        if (const auto found = statuses.find(busy); found != statuses.end() && found->second.state != State::busy)
            return;
        const auto left = std::chrono::ceil<std::chrono::microseconds>(end - ground_.now());
        ground_.sleep(std::min<std::chrono::microseconds>(left, std::chrono::milliseconds(200)));
    }
}

void Round::perform(const Step& step)
{
    switch (step.verb) {
    case Verb::set_one:
    case Verb::set_all: return set(step);
    case Verb::set_twice: return set_twice(step);
    case Verb::set_and_kill: return set_and_kill(step);
    case Verb::connect_all: return connect_all(step);
    case Verb::replace:
        if (step.second == static_cast<int>(Meanwhile::set_all))
            return set_and_replace(step);
        break;
    case Verb::stop: stopped_.insert(step.drone); break;
    case Verb::kill: wait(std::chrono::milliseconds(step.number)); break;
    case Verb::fail:
        ground_.perform(step);
        if (step.second == static_cast<int>(Failure::hangs))
            wait(std::chrono::milliseconds(step.number), step.drone);
        return;
    case Verb::start:
        if (stopped_.erase(step.drone) > 0 && plan_.topology.is_worker(step.drone))
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

/// Says what is not connected of all that can answer.
/// @param timeout  the caller gives up then
Problems Round::connect_all(std::chrono::milliseconds timeout)
{
    std::vector<SwarmConnection> all;
    const auto names = ground_.answering();
    for (const auto& [sender, receiver, options] : plan_.topology.edges())
        if (std::ranges::count(names, sender) > 0 && std::ranges::count(names, receiver) > 0)
            all.push_back({{sender, Topology::output_of(sender)}, {receiver, Topology::input_of(receiver)}, options});
    Problems problems;
    for (const auto& [sender, receiver, error] : ground_.connect(all, timeout))
        if (error)
            problems.push_back("connect all: " + to_text(sender) + " and " + to_text(receiver) + ": " + error->what());
    return problems;
}

/// Whatever happens meanwhile: a repeated call connects all.
void Round::connect_all(const Step& step)
{
    const auto time = std::chrono::microseconds(100 * step.number);
    const auto besides = [&](const std::function<void()>& other) {
        Problems problems;
        ground_.at_once([&] { problems = connect_all(); },
                        [&] {
                            ground_.sleep(time);
                            other();
                        });
        return problems;
    };
    const auto note = [&](const Problems& problems) {
        problems_.insert(problems_.end(), problems.begin(), problems.end());
    };
    switch (static_cast<Meanwhile>(step.second)) {
    case Meanwhile::twice: note(besides([&] { note(connect_all()); })); break;
    case Meanwhile::other_too: besides([&] { ground_.perform({.verb = Verb::replace, .drone = step.drone}); }); break;
    case Meanwhile::kill_old:
        besides([&] { ground_.perform({.verb = Verb::kill, .drone = step.drone}); });
        ground_.perform({.verb = Verb::start, .drone = step.drone});
        break;
    case Meanwhile::kill_caller: connect_all(std::chrono::ceil<std::chrono::milliseconds>(time)); break;
    default: break;
    }
    note(connect_all());
}

void Round::listen()
{
    for (const auto& outcome : ground_.outcomes())
        for (auto& problem : {model_.came(outcome), fates_.came(outcome)})
            if (problem)
                problems_.push_back(*problem);
}

}  // namespace hive::mixtures
