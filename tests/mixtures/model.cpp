// What is promised. A source on demand, and a collector that stays:
//
//   Each event gives exactly one result for each way through the plain stages (one drone of each), or one exception
//   that ends all ways through the drone that told it. A stage that shares has no ways of its own: whichever member
//   does the work, it is done once. That holds whatever is killed, frozen or halted, and whoever leaves a group.
//
// What ends a promise (then there is at most one result or exception):
//
//   - The source is killed or stopped: what it had produced in that life.
//   - A plain drone is disconnected or stopped by order: what it has not answered, and what is produced until it is
//     connected again.
//   - The last member of a group is disconnected from a worker by order, so the worker has no receiver. If it was the
//     source, the source continues for its bystanders.
//   - A sender is restarted, and two or more plain drones or collectors receive from it: it does not know them until
//     they reconnect, so what it sends meanwhile reaches only those that have.
//   - A drone whose code throws is restarted: exceptions wait for no receiver, and who receives them reconnects later.
//   - Two machines are parted, or a drone is dead meanwhile, for so long that a place may be given up.
//
// Not promised: that an event which a drone gives up has no result besides this exception. The drone may be killed or
// replaced before it acknowledges the event, another member of its group may have the event, too, it may disconnect a
// receiver that still processes the event, or the receiver gave the result before it was killed or replaced, and failed
// at the event again. A collector in order rejects the second answer (SPEC.md, section 8.5).
//
// A live source owes nothing but that no result comes twice, and that what is collected in order is in order.
#include "model.hpp"

#include <algorithm>

namespace hive::mixtures {
namespace {

template <class List>
bool begins_with(const List& list, const List& beginning)
{
    return beginning.size() <= list.size() && std::equal(beginning.begin(), beginning.end(), list.begin());
}

std::string number_of(std::int64_t epoch, std::int64_t sequence)
{
    return std::to_string(sequence) + " (epoch " + std::to_string(epoch) + ")";
}

std::string joined(const std::vector<std::string>& names)
{
    std::string text;
    for (const auto& name : names)
        text += (text.empty() ? "" : ", ") + name;
    return text;
}

/// Without its peer, for at least so long.
constexpr std::chrono::seconds place_kept(20);

}  // namespace

std::string to_text(const Outcome& outcome)
{
    return (outcome.failed ? "the exception \"" + outcome.text + "\" of " : "a result of ") + outcome.sender
           + " by way of " + joined(outcome.hops);
}

Outcome outcome_of(const Event& event, bool failed)
{
    Outcome outcome{.failed = failed,
                    .sender = event.sender,
                    .text = {},
                    .epoch = event.identity.epoch,
                    .sequence = event.identity.sequence,
                    .hops = {}};
    if (!failed)
        outcome.index = event.header.value("index", std::int64_t{0});
    else
        outcome.text = event.header.value("code", "") + ": " + event.header.value("text", "");
    for (const auto& hop : event.identity.hops)
        outcome.hops.push_back(hop.drone);
    for (const auto& share : event.identity.shares)
        if (const auto dot = share.to.rfind('.'); failed && dot != std::string::npos)
            outcome.hops.push_back(share.to.substr(0, dot));  // of a receiver that was given up
    return outcome;
}

Model::Model(const Topology& topology, std::int64_t collectors)
    : topology_(topology), condition_(topology), collectors_(collectors)
{
    // They are connected one after the other, and bystanders last.
    excuse_plain(topology_.stages.front());
    excuse_each(topology_.bystanders);
}

void Model::before(const Step& step, Time now)
{
    const auto was = condition_;
    condition_.follow(step);
    if (step.verb == Verb::stop || (step.verb == Verb::start && stopped_.contains(step.drone)))
        began_anew(step.drone);
    if (step.verb == Verb::kill || step.verb == Verb::set_and_kill || step.verb == Verb::replace
        || step.verb == Verb::connect_all) {
        cut_short_.insert({step.drone, step.sender});  // two may be replaced at once
        died_.insert({step.drone, step.sender});
    } else if (step.verb == Verb::disconnect || step.verb == Verb::forget)
        cut_short_.insert(step.sender);
    if (step.verb == Verb::stop)
        stopped_.insert(step.drone);
    else if (step.verb == Verb::start)
        stopped_.erase(step.drone);
    if (step.verb == Verb::connect_all)
        std::erase_if(alone_, [&](const auto& edge) { return was.runs(edge.first) && was.runs(edge.second); });
    else if (step.verb == Verb::connect)
        alone_.erase({step.sender, step.drone});
    else if (step.verb == Verb::change && topology_.edge_of(step).options.group.empty())
        alone_.insert({step.sender, step.drone});
    for (const auto& edge : topology_.edges())
        if (was.connected(edge.sender, edge.receiver) && !condition_.connected(edge.sender, edge.receiver))
            left(edge.sender, edge.receiver, has_another(edge.sender, edge.receiver, false));
    const auto parted = std::chrono::milliseconds(step.verb == Verb::part ? step.number : 0);
    parted_ += parted;
    if (parted_ > place_kept)
        excuse("");
    if (step.settle)
        parted_ = {};
    note_dead(now, now + parted);
    if (step.verb == Verb::forget)
        left(step.sender, step.drone, has_another(step.sender, step.drone, true));
}

/// A shared stage is excused only if none of its members runs.
void Model::excuse_stage_of(const std::string& drone)
{
    const auto& stage = topology_.stages.at(topology_.stage_of(drone));
    if (!stage.shared())
        excuse(drone);
    else if (std::ranges::none_of(stage.drones, [&](const auto& member) { return condition_.runs(member); }))
        excuse("");
}

/// @param until  by then places may have been given up
void Model::note_dead(Time now, Time until)
{
    for (const auto& [drone, life] : condition_.lives()) {
        if (condition_.runs(drone)) {
            dead_since_.erase(drone);
            continue;
        }
        const auto away = until - dead_since_.try_emplace(drone, now).first->second;
        if (away > place_kept && topology_.is_bystander(drone))
            excuse(drone);
        else if (away > place_kept && topology_.is_worker(drone))
            excuse_stage_of(drone);
    }
}

std::set<std::string> Model::halted() const
{
    std::set<std::string> drones;
    for (const auto& [drone, life] : condition_.lives())
        if (life == Life::halted)
            drones.insert(drone);
    return drones;
}

/// @param running  only what runs counts
bool Model::has_another(const std::string& sender, const std::string& receiver, bool running) const
{
    return std::ranges::any_of(topology_.edges(), [&](const Edge& edge) {
        return edge.sender == sender && edge.receiver != receiver && topology_.is_worker(edge.receiver)
               && condition_.connected(sender, edge.receiver) && (!running || condition_.runs(edge.receiver));
    });
}

void Model::began_anew(const std::string& drone)
{
    began_anew_ = true;
    excuse_receivers_of(drone);
    if (!topology_.is_worker(drone))
        return;
    const auto& stage = topology_.stages.at(topology_.stage_of(drone));
    if (topology_.may_throw(stage))
        excuse(stage.shared() ? "" : drone);
}

void Model::left(const std::string& sender, const std::string& receiver, bool another)
{
    if (!topology_.is_worker(receiver))
        return;
    const auto& stage = topology_.stages.at(topology_.stage_of(receiver));
    if (!stage.shared() || alone_.contains({sender, receiver}))
        return excuse(stage.shared() ? "" : receiver);
    if (another)
        return;
    if (sender == source && !topology_.bystanders.empty())
        excuse("");
    else if (sender != source)
        excuse(topology_.stages.at(topology_.stage_of(sender)).shared() ? "" : sender);
}

void Model::excuse_receivers_of(const std::string& drone)
{
    if (drone != source && !topology_.is_worker(drone))
        return;
    const auto next = drone == source ? 0 : topology_.stage_of(drone) + 1;
    if (next >= topology_.stages.size()) {
        if (collectors_ > 1)
            excuse(topology_.stages.back().shared() ? "" : drone);
        return;
    }
    const auto& stage = topology_.stages[next];
    if (drone != source || topology_.bystanders.empty())
        return excuse_plain(stage);
    stage.shared() ? excuse("") : excuse_each(stage.drones);
    excuse_each(topology_.bystanders);
}

/// They do not come at once.
void Model::excuse_plain(const Stage& stage)
{
    if (!stage.shared() && stage.drones.size() > 1)
        excuse_each(stage.drones);
}

void Model::excuse_each(const std::vector<std::string>& drones)
{
    std::ranges::for_each(drones, [this](auto& drone) { excuse(drone); });
}

void Model::excuse(const std::string& drone) { excuses_.push_back({drone, 0, open}); }

std::vector<std::string> Model::excused() const
{
    std::set<std::string> drones;
    for (const auto& excuse : excuses_)
        if (excuse.until == open)
            drones.insert(excuse.drone);
    return {drones.begin(), drones.end()};
}

void Model::whole(const std::string& drone, std::int64_t epoch, std::int64_t produced)
{
    for (auto& excuse : excuses_)
        if (excuse.until == open && excuse.drone == drone)
            excuse.epoch = epoch, excuse.until = produced;
}

bool Model::is_excused(const Way& way, std::int64_t epoch, std::int64_t sequence) const
{
    return std::ranges::any_of(excuses_, [&](const Excuse& excuse) {
        const bool this_way = excuse.drone.empty() || std::ranges::count(way, excuse.drone) > 0;
        return this_way && (excuse.until == open || (excuse.epoch == epoch && sequence <= excuse.until));
    });
}

Model::Way Model::way_of(const Outcome& outcome) const
{
    Way way;
    for (const auto& stage : topology_.stages)
        for (const auto& drone : stage.drones)
            if (!stage.shared() && (outcome.sender == drone || std::ranges::count(outcome.hops, drone) > 0))
                way.push_back(drone);
    return way;
}

/// The last bystander that an exception came through.
std::optional<std::string> Model::bystander_of(const Outcome& outcome) const
{
    const auto last = std::find_if(topology_.bystanders.rbegin(), topology_.bystanders.rend(), [&](const auto& drone) {
        return outcome.sender == drone || std::ranges::count(outcome.hops, drone) > 0;
    });
    return last == topology_.bystanders.rend() ? std::nullopt : std::optional(*last);
}

bool Model::owes(const Way& bystanders, std::int64_t epoch, std::int64_t sequence) const
{
    return !is_excused(bystanders, epoch, sequence) && std::ranges::none_of(bystanders, [&](const auto& drone) {
        return given_up_.contains({drone, std::pair(epoch, sequence)});
    });
}

std::vector<Model::Way> Model::ways() const
{
    std::vector<Way> ways{{}};
    for (const auto& stage : topology_.stages) {
        if (stage.shared())
            continue;
        std::vector<Way> longer;
        for (const auto& way : ways)
            for (const auto& drone : stage.drones) {
                longer.push_back(way);
                longer.back().push_back(drone);
            }
        ways = std::move(longer);
    }
    return ways;
}

bool Model::may_come_beside(const Outcome& outcome) const
{
    const auto& drone = outcome.sender;
    return outcome.failed && outcome.text.starts_with("abandoned")
           && (cut_short_.contains(drone)
               || std::ranges::any_of(outcome.hops, [&](auto& hop) { return cut_short_.contains(hop); })
               || (drone != source && topology_.stages[topology_.stage_of(drone)].shared())
               || (outcome.text.ends_with(" attempts") && died_in_next_stage(drone)));
}

/// An exception of a group names no member.
bool Model::died_in_next_stage(const std::string& drone) const
{
    const auto next = drone == source ? 0 : topology_.stage_of(drone) + 1;
    return next < topology_.stages.size() && topology_.stages[next].shared()
           && std::ranges::any_of(topology_.stages[next].drones,
                                  [&](const auto& member) { return died_.contains(member); });
}

std::optional<std::string> Model::came(const Outcome& outcome)
{
    const auto way = way_of(outcome);
    const auto event = std::pair(outcome.epoch, outcome.sequence);
    if (const auto bystander = bystander_of(outcome)) {
        given_up_.emplace(*bystander, event);
        return std::nullopt;
    }
    auto& before = came_[event];
    for (const auto& other : before)
        if (may_come_beside(other.outcome) == may_come_beside(outcome)
            && (other.way == way || (other.outcome.failed && begins_with(way, other.way))
                || (outcome.failed && begins_with(other.way, way))))
            return "once: event " + number_of(event.first, event.second) + " was answered twice: by "
                   + to_text(other.outcome) + ", and then by " + to_text(outcome);
    before.push_back({way, outcome});
    if (outcome.failed || !topology_.ordered)
        return std::nullopt;
    const auto last =
        std::exchange(last_[{way, outcome.epoch}], event);  // SPEC.md, section 8.5: order is that of one epoch
    if (event < last)
        return "order: the result of event " + number_of(event.first, event.second) + " came after that of "
               + number_of(last.first, last.second);
    return std::nullopt;
}

std::vector<std::string> Model::missing(std::int64_t epoch, std::int64_t produced) const
{
    std::vector<std::string> missing;
    const auto all = ways();
    for (std::int64_t sequence = 1; sequence <= produced; ++sequence) {
        const auto found = came_.find({epoch, sequence});
        for (const auto& way : all) {
            const bool answered = found != came_.end() && std::ranges::any_of(found->second, [&](auto& came) {
                                      return begins_with(way, came.way);
                                  });
            if (!answered && !is_excused(way, epoch, sequence))
                missing.push_back("outcome: event " + number_of(epoch, sequence) + " gave neither result nor exception"
                                  + (way.empty() ? "" : " by way of " + joined(way)));
        }
    }
    return missing;
}

std::int64_t Model::results_owed(std::int64_t epoch, std::int64_t sequence) const
{
    const auto found = came_.find({epoch, sequence});
    if (found == came_.end())
        return 0;
    return std::ranges::count_if(
        found->second, [&](auto& came) { return !came.outcome.failed && !is_excused(came.way, epoch, sequence); });
}

bool Model::any_failed() const
{
    return std::ranges::any_of(came_, [](const auto& event) {
        return std::ranges::any_of(event.second, [](auto& came) { return came.outcome.failed; });
    });
}

std::int64_t Model::failed_early() const
{
    const auto& ends = topology_.stages.back().drones;
    std::int64_t exceptions = 0;
    for (const auto& [event, all] : came_)
        exceptions += std::ranges::count_if(
            all, [&](auto& came) { return came.outcome.failed && std::ranges::count(ends, came.outcome.sender) == 0; });
    return exceptions;
}

}  // namespace hive::mixtures
