// Waiting until nothing changes any more, and what must hold then.
#include "picture.hpp"
#include "round.hpp"

#include <algorithm>
#include <utility>

namespace hive::mixtures {

using namespace std::chrono_literals;

void Stillness::look(std::string picture)
{
    const auto now = ground_.now();
    since_ += std::max<Ground::Clock::duration>(now - std::exchange(looked_, now) - 100ms, 0ms);
    if (!picture.empty() && picture == picture_)
        return;
    picture_ = std::move(picture);
    since_ = now;
}

bool Round::source_done(const Statuses& statuses) const
{
    const auto found = statuses.find(source);
    return found != statuses.end() && found->second.outputs.at(0).produced >= ground_.fed();
}

/// Are all edges of a drone ("": of all) there, those to collectors too, and are the exceptions heard that it may
/// throw?
bool Round::whole(const Statuses& statuses, const std::string& drone) const
{
    for (const auto& stage : plan_.topology.stages)
        for (const auto& worker : stage.drones)
            if (plan_.topology.may_throw(stage) && (drone.empty() || worker == drone) && !heard(statuses, worker))
                return false;
    for (const auto& worker : plan_.topology.stages.back().drones)
        if (ground_.collectors() > 1 && (drone.empty() || worker == drone)
            && collectors_of(statuses, worker) < ground_.collectors())
            return false;
    for (const auto& bystander : {forker, joiner})
        if (plan_.topology.is_bystander(bystander) && (drone.empty() || bystander == drone)
            && !all_collected(statuses, bystander))
            return false;
    return std::ranges::all_of(plan_.topology.edges(), [&](const Edge& edge) {
        return (!drone.empty() && edge.sender != drone && edge.receiver != drone) || connected(statuses, edge);
    });
}

void Round::end_excuses(const Statuses& statuses)
{
    const auto found = statuses.find(source);
    if (found == statuses.end() || !ground_.all_hear())
        return;
    for (const auto& drone : model_.excused())
        if (whole(statuses, drone))
            model_.whole(drone, found->second.epoch, ground_.statuses().at(source).outputs.at(0).produced);
}

Problems Round::missing(const Statuses& statuses) const
{
    const auto found = statuses.find(source);
    if (!plan_.topology.demand || found == statuses.end())
        return {};
    const auto missing = model_.missing(found->second.epoch, found->second.outputs.at(0).produced);
    // An exception waits for nobody: what a drone told before it was heard again cannot come.
    return static_cast<std::int64_t>(missing.size()) <= unheard(statuses) ? Problems{} : missing;
}

/// A source on demand that does not move must say why.
Problems Round::stuck(const Statuses& statuses, Stillness& stillness) const
{
    const auto found = statuses.find(source);
    if (!plan_.topology.demand || found == statuses.end())
        return {};
    const auto produced = found->second.outputs.at(0).produced;
    stillness.look(std::to_string(found->second.epoch) + " " + std::to_string(produced));
    if (!stillness.still() || produced >= ground_.fed() || says_why(found->second))
        return {};
    return {"why: the source has not moved for " + std::to_string(ground_.stillness().count())
            + " ms and does not say why"};
}

Problems Round::watch(const Statuses& statuses)
{
    auto problems = unbalanced(statuses);
    const auto add = [&](const Problems& more) { problems.insert(problems.end(), more.begin(), more.end()); };
    add(contradictory(statuses));
    add(watch_.look(statuses));
    add(window_.look(statuses));
    add(sizes_.look(statuses));
    add(waits_.look(statuses));
    add(fates_.look(statuses));
    const Statuses unknown;
    const auto& heard = ground_.all_hear() ? statuses : unknown;
    add(lease_.look(heard, ground_.now()));
    add(overdue_.look(heard, ground_.now()));
    add(idle_.look(heard, ground_.now()));
    add(wrongly_connected(statuses, model_.wanted()));
    add(wrongly_resumed(statuses, model_.halted()));
    add(impossible_ages(statuses, ground_.age(), ground_.age_error()));
    if (plan_.topology.demand)
        add(pace_.look(statuses, ground_.fed(), ground_.now()));
    add(ground_.complaints());
    return problems;
}

/// Are all there, connected and not halted?
bool Round::all_up(const Statuses& statuses) const
{
    const auto halted = [](const auto& row) { return row.second.state == State::halted; };
    return statuses.size() == plan_.topology.drones().size() && std::ranges::none_of(statuses, halted)
           && whole(statuses, "");
}

/// Does the collector know that it has everything, if it can?
bool Round::told_end(const Statuses& statuses) const
{
    return !plan_.faults.contains(fault::ends) || !all_up(statuses) || ground_.ended();
}

Problems Round::settle(bool last)
{
    while (!ground_.all_hear())
        ground_.sleep(20ms);
    Stillness all(ground_), source_alone(ground_);
    const auto most_time = ground_.longest_settling();
    for (const auto end = ground_.now() + most_time; ground_.now() < end; ground_.sleep(20ms)) {
        const auto statuses = ground_.statuses();
        listen();
        end_excuses(statuses);
        auto problems = watch(statuses);
        std::ranges::move(stuck(statuses, source_alone), std::back_inserter(problems));
        if (!problems.empty() || !problems_.empty())
            return problems;
        const bool answered = statuses.size() == ground_.answering().size();
        all.look(answered ? "those that answer:\n" + fingerprint(statuses) : "");
        const bool done =
            answered && idle(statuses, all.still()) && source_done(statuses) && (!last || whole(statuses, ""));
        // In order, a result that is late holds up others that are acknowledged.
        const bool over = done && (missing(statuses).empty() || (all.still() && !plan_.topology.ordered));
        if (over && told_end(statuses))
            return at_rest(statuses, true);
        if (!done && !last && all.still())
            return at_rest(statuses, false);
    }
    const auto statuses = ground_.statuses();
    auto problems = missing(statuses);
    if (!told_end(statuses))
        problems.insert(problems.begin(), "end: the source has ended, and the collector is not told");
    problems.insert(problems.begin(), "settles: no rest in " + std::to_string(most_time.count()) + " ms");
    return problems;
}

Problems Round::at_rest(const Statuses& statuses, bool complete)
{
    auto problems = complete ? missing(statuses) : without_reason(statuses);
    std::ranges::move(disagreeing(statuses, ground_.born()), std::back_inserter(problems));
    if (!complete)
        std::ranges::move(with_false_reason(statuses), std::back_inserter(problems));
    if (auto problem = values_.found(ground_.settings()))
        problems.push_back(*problem);
    // A drone that has halted does not keep back that there is more.
    const bool more = !source_done(statuses) || !missing(statuses).empty();
    if (more && ground_.ended() && statuses.size() == plan_.topology.drones().size() && whole(statuses, ""))
        problems.push_back("end: the collector was told the end, and something is still to come");
    if (statuses.contains(source))
        if (const auto count = ground_.count(); count != ground_.fed())
            problems.push_back("restored: the source's count is " + std::to_string(count) + "; "
                               + std::to_string(ground_.fed()) + " was confirmed");
    const auto counts = ground_.collected();
    // A collector in order learns with the first result whose exceptions it has to hear: it may have missed those of
    // earlier stages, and each of them ends the ways to all ends.
    const auto unheard = model_.failed_early() * static_cast<std::int64_t>(plan_.topology.stages.back().drones.size());
    const auto lost = counts.dropped + std::max<std::int64_t>(counts.missing - unheard, 0);
    // What an earlier run of the source had given out and nobody has answered is missing once the end is known.
    const bool of_earlier_run = plan_.faults.contains(fault::ends) && ground_.born().at(source) > 0;
    if (complete && plan_.topology.demand && !model_.was_excused() && !of_earlier_run && lost > 0)
        problems.push_back("outcome: the collector counts " + std::to_string(counts.missing) + " missing and "
                           + std::to_string(counts.dropped) + " dropped");
    return problems;
}

}  // namespace hive::mixtures
