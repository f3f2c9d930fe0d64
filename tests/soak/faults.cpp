// Faults by kind; some hit a second drone while the first one is away.
#include "faults.hpp"

#include <topology.hpp>

namespace hive::soak {
namespace {

using mixtures::Random;
using mixtures::Step;
using mixtures::Verb;
using std::chrono::milliseconds;

class Drawer {
public:
    Drawer(Random& random, const Swarm& swarm) : random_(random), swarm_(swarm) {}

    Fault fault()
    {
        switch (random_.between(0, 12)) {
        case 0:
        case 1: away(Verb::kill, Verb::start, any_drone()); break;
        case 2: freeze(any_drone()); break;
        case 3: away(Verb::halt, Verb::resume, worker()); break;
        case 4: leave(worker()); break;
        case 5: reconnect(); break;
        case 6: add({}, {.verb = Verb::replace, .drone = any_drone()}); break;
        case 7: change(); break;
        case 8: set(); break;
        case 9: fail(worker()); break;
        case 10: swallow(); break;
        default: cut(); break;
        }
        return std::move(fault_);
    }

private:
    void add(milliseconds pause, Step step) { fault_.steps.push_back({pause, std::move(step)}); }
    std::string any_drone() { return random_.pick(swarm_.topology.drones()); }
    std::string worker() { return random_.pick(swarm_.topology.workers()); }
    std::string machine() { return swarm_.places.at(any_drone()); }

    /// Mostly too briefly to be noticed or just long enough; now and then long enough for `explain` to be asked.
    milliseconds absence() { return milliseconds(random_.between(50, random_.chance(15) ? 14'000 : 5000)); }

    void away(Verb verb, Verb back, const std::string& drone)
    {
        add({}, {.verb = verb, .drone = drone});
        add(absence(), {.verb = back, .drone = drone});
    }

    void freeze(const std::string& drone)
    {
        const auto time = absence();
        add({}, {.verb = Verb::freeze, .drone = drone});
        add(time, {.verb = Verb::thaw, .drone = drone, .number = static_cast<int>(time.count())});
    }

    /// It leaves and forgets what it was told, and joins again.
    void leave(const std::string& drone)
    {
        away(Verb::stop, Verb::start, drone);
        for (const auto& edge : swarm_.topology.edges())
            if (edge.receiver == drone)
                add({}, {.verb = Verb::connect, .drone = drone, .sender = edge.sender});
    }

    mixtures::Edge edge()
    {
        auto edges = swarm_.topology.edges();
        std::erase_if(edges, [](const auto& edge) { return edge.receiver == mixtures::watcher; });
        return random_.pick(edges);
    }

    void reconnect()
    {
        const auto pair = edge();
        add({}, {.verb = Verb::disconnect, .drone = pair.receiver, .sender = pair.sender});
        add(absence(), {.verb = Verb::connect, .drone = pair.receiver, .sender = pair.sender});
    }

    /// Whether it shares makes no difference to what a drone owes that is alone in its stage.
    void change()
    {
        const auto pair = edge();
        const auto& stage = swarm_.topology.stages.at(swarm_.topology.stage_of(pair.receiver));
        add({}, {.verb = Verb::change,
                 .drone = pair.receiver,
                 .sender = pair.sender,
                 .number = random_.between(1, 8),
                 .second = random_.between(0, stage.drones.size() == 1 ? 2 : 1)});
    }

    void set()
    {
        const Step step{.verb = random_.pick(std::vector{Verb::set_one, Verb::set_all, Verb::set_twice}),
                        .drone = worker(),
                        .number = random_.between(1, 12),
                        .second = random_.between(6, 20)};
        add({}, step);
        if (!random_.chance(30))
            return;
        add({}, {.verb = Verb::set_and_kill, .drone = step.drone, .number = step.number, .second = step.second});
        add(absence(), {.verb = Verb::start, .drone = step.drone});
    }

    /// An exception waits for no receiver, so nothing else is broken meanwhile.
    void fail(const std::string& drone)
    {
        fault_.from_rest = true;
        add({}, {.verb = Verb::fail, .drone = drone});
    }

    void swallow()
    {
        const auto from = machine();
        auto to = from;
        while (to == from)
            to = machine();
        add({}, {.verb = Verb::swallow, .drone = to, .sender = from});
        meanwhile();
        add(absence(), {.verb = Verb::let_through, .drone = to, .sender = from});
    }

    void cut()
    {
        const auto name = machine();
        add({}, {.verb = Verb::cut, .drone = name});
        meanwhile();
        add(absence(), {.verb = Verb::mend, .drone = name});
    }

    void meanwhile()
    {
        if (!random_.chance(35))
            return;
        const auto drone = any_drone();
        add(milliseconds(random_.between(10, 3000)), {.verb = Verb::kill, .drone = drone});
        add(milliseconds(random_.between(10, 3000)), {.verb = Verb::start, .drone = drone});
    }

    Random& random_;
    const Swarm& swarm_;
    Fault fault_;
};

}  // namespace

Swarm make_swarm(mixtures::Random& random)
{
    Swarm swarm;
    ConnectionOptions shared{.window = random.between(1, 4), .group = "workers", .lease = {}};
    shared.lease = milliseconds(random.pick(std::vector{2000, 4000}));
    ConnectionOptions plain{.window = random.between(1, 8), .group = {}, .lease = {}};
    if (random.chance(40))
        plain = {.transfer = Transfer::streaming, .group = {}, .lease = {}};
    swarm.topology = {
        .demand = true, .ordered = false, .watched = true, .stages = {{{"a1", "a2", "a3"}, shared}, {{"b1"}, plain}}};
    swarm.places = {{mixtures::source, "cam1"},
                    {mixtures::watcher, "gpu1"},
                    {"a1", "gpu1"},
                    {"a2", "gpu2"},
                    {"a3", "gpu1"},
                    {"b1", random.chance(50) ? "gpu2" : "cam1"}};
    return swarm;
}

Fault draw_fault(Random& random, const Swarm& swarm) { return Drawer(random, swarm).fault(); }

std::string to_text(const Fault& fault)
{
    std::string text;
    for (const auto& [pause, step] : fault.steps) {
        text += text.empty() ? "" : ", ";
        if (pause.count() > 0 && step.verb != Verb::thaw)  // whose text says so
            text += "after " + std::to_string(pause.count()) + " ms ";
        text += to_text(step);
    }
    return text;
}

}  // namespace hive::soak
