// Which drones a round has and how they are connected; plans and their parts as text.
#include "topology.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace hive::mixtures {
namespace {

ConnectionOptions options_of(Random& random, bool shared, char stage)
{
    ConnectionOptions options;
    if (!shared && random.chance(40))
        options.transfer = Transfer::streaming;
    else
        options.window = random.pick(std::vector{1, 1, 2, 3, 8});
    if (shared) {
        options.group = std::string("group-") + stage;
        options.lease = std::chrono::milliseconds(random.pick(std::vector{800, 1500, 4000}));
    }
    return options;
}

Stage make_stage(Random& random, char letter, int most)
{
    Stage stage;
    const int drones = random.between(1, most);
    for (int i = 1; i <= drones; ++i)
        stage.drones.push_back(letter + std::to_string(i));
    stage.options = options_of(random, random.chance(60), letter);
    if (random.chance(25))
        stage.throw_every = random.between(3, 15);
    return stage;
}

std::string words(const ConnectionOptions& options)
{
    std::string text = options.transfer == Transfer::streaming ? "stream" : "window " + std::to_string(options.window);
    if (!options.encoding.empty())
        text += ", as " + options.encoding;
    if (!options.group.empty())
        text +=
            ", shared, lease " + std::to_string(options.lease.value_or(std::chrono::milliseconds(0)).count()) + " ms";
    return text;
}

constexpr std::array verbs{"feed",      "connect", "change",  "disconnect", "kill",        "start",   "freeze",
                           "thaw",      "halt",    "resume",  "stop",       "set one",     "set all", "set two",
                           "set, kill", "rest",    "forget",  "replace",    "connect all", "fail",    "part",
                           "cut",       "mend",    "swallow", "let through"};
constexpr std::array failures{"", "and halts", "and crashes", "and hangs", "and lingers"};
constexpr std::array meanwhiles{"",
                                "by another kind",
                                "twice",
                                "and the other as well",
                                "and kill the old one",
                                "and kill the new one",
                                "and kill the caller",
                                "and set all"};

}  // namespace

std::string_view token(Verb verb) noexcept { return verbs.at(static_cast<std::size_t>(verb)); }
std::string_view token(Failure failure) noexcept { return failures.at(static_cast<std::size_t>(failure)); }
std::string_view token(Meanwhile meanwhile) noexcept { return meanwhiles.at(static_cast<std::size_t>(meanwhile)); }

Topology make_topology(Random& random)
{
    Topology topology;
    topology.demand = random.chance(75);
    topology.watched = random.chance(25);
    const bool two = random.chance(50);
    topology.stages.push_back(make_stage(random, 'a', two ? 2 : 4));
    if (two)
        topology.stages.push_back(make_stage(random, 'b', 2));
    topology.ordered = std::ranges::all_of(topology.stages, &Stage::shared) && random.chance(40);
    return topology;
}

std::vector<Edge> Topology::edges() const
{
    std::vector<Edge> edges;
    for (const auto& drone : bystanders)
        edges.push_back(drone == joiner ? Edge{forker, joiner, {}} : Edge{source, drone, {.window = 8, .group = {}}});
    std::vector<std::string> senders{source};
    for (const auto& stage : stages) {
        for (const auto& sender : senders)
            for (const auto& receiver : stage.drones)
                edges.push_back({sender, receiver, stage.options});
        senders = stage.drones;
    }
    if (watched)
        edges.push_back({source, watcher, {.delivery = Delivery::notification, .group = {}}});
    return edges;
}

std::vector<std::string> Topology::workers() const
{
    std::vector<std::string> names;
    for (const auto& stage : stages)
        names.insert(names.end(), stage.drones.begin(), stage.drones.end());
    return names;
}

std::vector<std::string> Topology::drones() const
{
    auto names = workers();
    names.insert(names.begin(), source);
    names.insert(names.end(), bystanders.begin(), bystanders.end());
    if (watched)
        names.push_back(watcher);
    return names;
}

std::size_t Topology::stage_of(const std::string& worker) const
{
    return static_cast<std::size_t>(
        std::ranges::find_if(stages, [&](auto& stage) { return std::ranges::count(stage.drones, worker) > 0; })
        - stages.begin());
}

Edge Topology::edge_of(const Step& step) const
{
    for (auto& edge : edges()) {
        if (edge.sender != step.sender || edge.receiver != step.drone)
            continue;
        if (step.verb != Verb::change)
            return edge;
        auto& options = edge.options;
        options.window = step.number;
        if (step.second == 2) {
            options.group = options.group.empty() ? "others" : "";
            options.lease = std::chrono::milliseconds(1500);
        }
        options.transfer = step.second == 1 && options.group.empty() ? Transfer::streaming : Transfer::synchronized;
        return edge;
    }
    throw std::logic_error("there is no edge of " + to_text(step));
}

std::string to_text(const Topology& topology)
{
    std::string text = topology.demand ? "source on demand" : "live source";
    for (const auto& stage : topology.stages) {
        text += " ->";
        for (const auto& drone : stage.drones)
            text += " " + drone;
        text += " (" + words(stage.options);
        if (stage.throw_every > 0)
            text += ", throws on every " + std::to_string(stage.throw_every);
        text += ")";
    }
    text += topology.ordered ? " -> collected in order" : " -> collected";
    if (topology.is_bystander(joiner))
        text += "; source -> fork (window 8) -> pair";
    return topology.watched ? text + "; source -> watcher (notify)" : text;
}

std::string to_text(const Step& step)
{
    std::string text(token(step.verb));
    if (!step.sender.empty())
        text += " " + step.sender + " and";
    if (!step.drone.empty())
        text += " " + step.drone;
    if ((step.verb == Verb::thaw || step.verb == Verb::kill) && step.number > 0)
        text += " after " + std::to_string(step.number) + " ms";
    else if (step.number > 0)
        text += " " + std::to_string(step.number);
    if (step.second > 0 && (step.verb == Verb::replace || step.verb == Verb::connect_all))
        text += " " + std::string(token(static_cast<Meanwhile>(step.second)));
    else if (step.second > 0 && step.verb == Verb::fail)
        text += " " + std::string(token(static_cast<Failure>(step.second)));
    else if (step.second > 0 && step.verb == Verb::stop)
        text += " while it hangs";
    else if (step.second > 0)
        text += " " + std::to_string(step.second);
    return step.settle ? text + ", then check" : text;
}

}  // namespace hive::mixtures
