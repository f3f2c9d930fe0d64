// From a seed to a sequence of steps: what is broken is known at each step, so every step makes sense where it stands.
#include "condition.hpp"
#include "random.hpp"
#include "topology.hpp"

#include <algorithm>

namespace hive::mixtures {
namespace {

/// Words that mend are likelier than words that break, and no more than two drones are broken at once.
class Planner {
public:
    Planner(const Plan& plan, Random& random)
        : topology_(plan.topology),
          random_(random),
          forgets_(plan.faults.contains(fault::forget)),
          replaces_(plan.faults.contains(fault::replace)),
          parts_(plan.faults.contains(fault::part)),
          connects_(plan.faults.contains(fault::connect_all)),
          two_die_(plan.faults.contains(fault::two_die)),
          condition_(topology_)
    {
    }

    std::vector<Step> steps(int wanted)
    {
        feed();
        while (static_cast<int>(steps_.size()) < wanted) {
            if (random_.chance(70))
                feed();
            one_of_many();
        }
        mend();
        return std::move(steps_);
    }

private:
    std::vector<std::string> workers_that_run() const
    {
        auto workers = topology_.workers();
        std::erase_if(workers, [&](const std::string& drone) { return !condition_.runs(drone); });
        return workers;
    }

    void add(Step step)
    {
        step.settle = step.settle || random_.chance(40);
        condition_.follow(step);
        steps_.push_back(std::move(step));
    }

    void feed()
    {
        if (condition_.runs(source))
            steps_.push_back({.verb = Verb::feed, .drone = source, .number = random_.between(5, 80)});
    }

    void one_of_many()
    {
        if (two_die_ && random_.chance(35))
            return two_die();
        std::vector<Step> choices;
        for (const auto& [drone, life] : condition_.lives())
            about(drone, life, choices);
        for (const auto& edge : topology_.edges())
            about(edge, choices);
        about_sets(choices);
        for (int i = 0; i < (parts_ ? 8 : 0); ++i)
            choices.push_back({.verb = Verb::part});
        for (int i = 0; i < (connects_ ? 12 : 0); ++i)
            choices.push_back({.verb = Verb::connect_all});
        take(random_.pick(choices));
    }

    /// The joiner keeps state.
    static bool may_be_replaced(const std::string& drone) { return drone != watcher && drone != joiner; }
    bool may_fail(const std::string& drone) const { return topology_.fails && topology_.is_worker(drone); }

    void about(const std::string& drone, Life life, std::vector<Step>& choices) const
    {
        const auto offer = [&](Verb verb, int times) {
            for (int i = 0; i < times; ++i)
                choices.push_back({.verb = verb, .drone = drone});
        };
        const bool another = condition_.broken() < 2;
        if (replaces_ && may_be_replaced(drone) && condition_.runs(drone))
            offer(Verb::replace, 6);
        switch (life) {
        case Life::up:
            offer(Verb::kill, another ? 4 : 0);
            offer(Verb::freeze, another ? 3 : 0);
            offer(Verb::halt, another ? 2 : 0);
            offer(Verb::stop, another && !topology_.is_bystander(drone) ? (may_fail(drone) ? 3 : 1) : 0);
            offer(Verb::fail, may_fail(drone) && another ? 5 : 0);
            break;
        case Life::killed:
        case Life::stopped: offer(Verb::start, 25); break;
        case Life::frozen: offer(Verb::thaw, 25); break;
        case Life::halted:
            offer(Verb::resume, 15);
            offer(Verb::kill, 2);
            break;
        }
    }

    void about(const Edge& edge, std::vector<Step>& choices) const
    {
        if (topology_.is_bystander(edge.receiver))
            return;
        const bool connected = condition_.connected(edge.sender, edge.receiver);
        if (forgets_ && connected && condition_.runs(edge.sender) && condition_.life(edge.receiver) == Life::killed)
            for (int i = 0; i < 10; ++i)
                choices.push_back({.verb = Verb::forget, .drone = edge.receiver, .sender = edge.sender});
        if (!condition_.runs(edge.sender) || !condition_.runs(edge.receiver))
            return;
        for (int i = 0; i < 2 && connected && edge.receiver != watcher; ++i)
            choices.push_back({.verb = Verb::change, .drone = edge.receiver, .sender = edge.sender});
        for (int i = 0; i < (connects_ ? (connected ? 6 : 1) : (connected ? 2 : 15)); ++i)
            choices.push_back(
                {.verb = connected ? Verb::disconnect : Verb::connect, .drone = edge.receiver, .sender = edge.sender});
    }

    void about_sets(std::vector<Step>& choices) const
    {
        const auto workers = workers_that_run();
        choices.push_back({.verb = Verb::rest, .settle = true});
        for (const auto& drone : workers)
            choices.push_back({.verb = Verb::set_one, .drone = drone});
        if (workers.size() < 2)
            return;
        choices.insert(choices.end(), {{.verb = Verb::set_all}, {.verb = Verb::set_twice}, {.verb = Verb::set_twice}});
        if (condition_.broken() < 2)
            choices.push_back({.verb = Verb::set_and_kill, .drone = workers.front()});
    }

    void take(Step step)
    {
        switch (step.verb) {
        case Verb::freeze: return freeze(step);
        case Verb::thaw: return thaw(step.drone);
        case Verb::replace: return replace(std::move(step));
        case Verb::connect_all: return connect_all(std::move(step));
        case Verb::fail:
            step.second = random_.between(0, 3);
            step.number = step.second == static_cast<int>(Failure::hangs) ? random_.between(100, 6000) : 0;
            break;
        case Verb::stop: step.second = may_fail(step.drone) ? random_.between(0, 1) : 0; break;
        case Verb::part:
            step.number = random_.between(200, random_.pick(std::vector{1500, 5000, 12'000, 40'000}));
            step.second = random_.between(0, 2);
            break;
        case Verb::change:
            step.number = random_.between(1, 8);
            step.second = random_.between(0, may_regroup(step.drone) ? 2 : 1);
            break;
        case Verb::set_and_kill: step.drone = random_.pick(workers_that_run()); [[fallthrough]];
        case Verb::set_one:
        case Verb::set_all:
        case Verb::set_twice:
            step.number = random_.between(1, 12);
            step.second = random_.between(6, 20);
            break;
        default: break;
        }
        add(std::move(step));
    }

    /// One that has halted stays halted only if it is not killed.
    void replace(Step step)
    {
        auto others = workers_that_run();
        std::erase(others, step.drone);
        const bool halted = condition_.life(step.drone) == Life::halted;
        const auto meanwhile = static_cast<Meanwhile>(random_.between(0, halted ? 1 : 7));
        const bool possible = meanwhile == Meanwhile::other_too ? !others.empty() && condition_.broken() == 0
                              : meanwhile == Meanwhile::set_all ? !others.empty()
                                                                : true;
        step.number = random_.between(1, meanwhile == Meanwhile::set_all ? 12 : 60);
        step.second = possible ? static_cast<int>(meanwhile) : 0;
        if (possible && meanwhile == Meanwhile::other_too)
            step.sender = random_.pick(others);
        add(std::move(step));
    }

    void connect_all(Step step)
    {
        step.second = static_cast<int>(random_.pick(std::vector{
            Meanwhile::nothing, Meanwhile::twice, Meanwhile::other_too, Meanwhile::kill_old, Meanwhile::kill_caller}));
        step.number = random_.between(1, 60);
        std::vector<std::string> drones;
        for (const auto& [drone, life] : condition_.lives())
            if (life == Life::up && may_be_replaced(drone))
                drones.push_back(drone);
        const auto meanwhile = static_cast<Meanwhile>(step.second);
        if (meanwhile == Meanwhile::other_too || meanwhile == Meanwhile::kill_old) {
            if (drones.empty())
                step.second = 0;
            else
                step.drone = random_.pick(drones);
        }
        add(std::move(step));
    }

    /// The receiver has events in hand while it and its sender die: what they answered, acknowledged or gave up has
    /// reached the drones beside them or not.
    void two_die()
    {
        auto edges = topology_.edges();
        std::erase_if(edges, [&](const Edge& edge) {
            return !topology_.is_worker(edge.receiver) || !condition_.connected(edge.sender, edge.receiver)
                   || condition_.life(edge.sender) != Life::up || condition_.life(edge.receiver) != Life::up;
        });
        if (edges.empty() || condition_.broken() > 0)
            return;
        const auto [sender, receiver, options] = random_.pick(edges);
        const auto now = [&](Step step) {
            condition_.follow(step);
            steps_.push_back(std::move(step));
        };
        const int works = random_.between(50, random_.pick(std::vector{500, 1500, 6000}));
        const int first = random_.between(0, 300);
        const bool when_done = random_.chance(50);  // the answer is under way
        const int second = when_done ? std::max(works - first, 0) + random_.between(0, 15)
                                     : random_.between(0, random_.pick(std::vector{500, 2000, 6000}));
        now({.verb = Verb::fail, .drone = receiver, .number = works, .second = static_cast<int>(Failure::lingers)});
        feed();
        now({.verb = Verb::kill, .drone = sender, .number = first});
        const bool restarts = random_.chance(60);
        if (restarts) {
            now({.verb = Verb::start, .drone = sender});
            feed();
        }
        now({.verb = Verb::kill, .drone = receiver, .number = second});
        if (!restarts)
            now({.verb = Verb::start, .drone = sender});
        add({.verb = Verb::start, .drone = receiver});
    }

    /// Whether it shares makes no difference to what a worker owes that is alone.
    bool may_regroup(const std::string& worker) const
    {
        return !topology_.ordered && topology_.stages.at(topology_.stage_of(worker)).drones.size() == 1;
    }

    /// For less time than a peer needs to be taken for dead, at once over; or for longer, with other steps in between.
    void freeze(const Step& step)
    {
        const bool brief = random_.chance(40);
        frozen_ms_[step.drone] = brief ? random_.between(50, 1300) : random_.between(2300, 3500);
        add(step);
        if (brief) {
            steps_.back().settle = false;
            thaw(step.drone);
        }
    }

    void thaw(const std::string& drone) { add({.verb = Verb::thaw, .drone = drone, .number = frozen_ms_[drone]}); }

    void mend()
    {
        for (const auto& drone : topology_.drones()) {
            const auto life = condition_.life(drone);
            if (life == Life::frozen)
                thaw(drone);
            else if (life != Life::up)
                take({.verb = life == Life::halted ? Verb::resume : Verb::start, .drone = drone});
        }
        for (const auto& edge : topology_.edges())
            if (!condition_.connected(edge.sender, edge.receiver))
                take({.verb = Verb::connect, .drone = edge.receiver, .sender = edge.sender});
        feed();
        steps_.push_back({.verb = Verb::rest, .settle = true});
    }

    const Topology& topology_;
    Random& random_;
    const bool forgets_, replaces_, parts_, connects_, two_die_;
    Condition condition_;
    std::map<std::string, int> frozen_ms_;
    std::vector<Step> steps_;
};

}  // namespace

Plan make_plan(std::uint64_t seed, int steps, const std::set<std::string>& faults)
{
    Random random(seed);
    Plan plan{.seed = seed, .size = steps, .topology = make_topology(random), .steps = {}, .faults = faults};
    plan.topology.fails = faults.contains(fault::fail);
    if (faults.contains(fault::join))
        plan.topology.bystanders = {forker, joiner};
    if (faults.contains(fault::bodies) && random.chance(60))
        plan.topology.stages.front().options.encoding = half_encoding;
    plan.steps = Planner(plan, random).steps(steps);
    return plan;
}

std::set<std::string> draw_faults(std::uint64_t seed, const std::set<std::string>& faults)
{
    Random random(~seed);  // not the generator of the plan
    const int percent = random.pick(std::vector{0, 0, 10, 25, 50});
    std::set<std::string> drawn;
    for (const auto& fault : faults)
        if (random.chance(percent))
            drawn.insert(fault);
    return drawn.empty() && !faults.empty() ? std::set{fault::none} : drawn;
}

std::string options_of(const Plan& plan)
{
    std::string options = "--seed " + std::to_string(plan.seed) + " --steps " + std::to_string(plan.size);
    for (const auto& fault : plan.faults)
        options += " --with " + fault;
    return options;
}

}  // namespace hive::mixtures
