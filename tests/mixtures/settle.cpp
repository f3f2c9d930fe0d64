// Waiting until nothing changes any more, and what must hold then.
#include "picture.hpp"
#include "round.hpp"

#include <algorithm>
#include <utility>

namespace hive::mixtures {
namespace {

using namespace std::chrono_literals;

/// Places are kept for 30 s, and so long an ordered collector waits.
constexpr auto most_time = test::sanitized() ? 90'000ms : 45'000ms;

}  // namespace

void Stillness::look(std::string picture)
{
    const auto now = test::Clock::now();
    since_ += std::max<test::Clock::duration>(now - std::exchange(looked_, now) - 100ms, 0ms);
    if (!picture.empty() && picture == picture_)
        return;
    picture_ = std::move(picture);
    since_ = now;
}

bool Round::source_done(const Statuses& statuses) const
{
    const auto found = statuses.find(source);
    return found != statuses.end() && found->second.outputs.at(0).produced >= running_.fed();
}

/// Are all edges of a drone ("": of all) there, and are the exceptions heard that it may throw?
bool Round::whole(const Statuses& statuses, const std::string& drone) const
{
    for (const auto& stage : plan_.topology.stages)
        for (const auto& worker : stage.drones)
            if (stage.throw_every > 0 && (drone.empty() || worker == drone) && !heard(statuses, worker))
                return false;
    return std::ranges::all_of(plan_.topology.edges(), [&](const Edge& edge) {
        return (!drone.empty() && edge.sender != drone && edge.receiver != drone) || connected(statuses, edge);
    });
}

void Round::end_excuses(const Statuses& statuses)
{
    const auto found = statuses.find(source);
    if (found == statuses.end())
        return;
    for (const auto& drone : model_.excused())
        if (whole(statuses, drone))
            model_.whole(drone, found->second.epoch, running_.statuses().at(source).outputs.at(0).produced);
}

Problems Round::missing(const Statuses& statuses) const
{
    const auto found = statuses.find(source);
    if (!plan_.topology.demand || found == statuses.end())
        return {};
    return model_.missing(found->second.epoch, found->second.outputs.at(0).produced);
}

/// A source on demand that does not move must say why.
Problems Round::stuck(const Statuses& statuses, Stillness& stillness) const
{
    const auto found = statuses.find(source);
    if (!plan_.topology.demand || found == statuses.end())
        return {};
    const auto produced = found->second.outputs.at(0).produced;
    stillness.look(std::to_string(found->second.epoch) + " " + std::to_string(produced));
    if (!stillness.still() || produced >= running_.fed() || says_why(found->second))
        return {};
    return {"the source has not moved for " + std::to_string(Stillness::time.count()) + " ms and does not say why"};
}

Problems Round::settle(bool last)
{
    Stillness all, source_alone;
    for (const auto end = test::Clock::now() + most_time; test::Clock::now() < end; std::this_thread::sleep_for(10ms)) {
        const auto statuses = running_.statuses();
        listen();
        end_excuses(statuses);
        auto problems = unbalanced(statuses);
        std::ranges::move(stuck(statuses, source_alone), std::back_inserter(problems));
        if (!problems.empty() || !problems_.empty())
            return problems;
        const bool answered = statuses.size() == running_.answering().size();
        all.look(answered ? "those that answer:\n" + picture(statuses) : "");
        const bool done = answered && idle(statuses) && source_done(statuses) && (!last || whole(statuses, ""));
        // In order, a result that is late holds up others that are acknowledged.
        if (done && (missing(statuses).empty() || (all.still() && !plan_.topology.ordered)))
            return at_rest(statuses, true);
        if (!done && !last && all.still())
            return at_rest(statuses, false);
    }
    const auto statuses = running_.statuses();
    auto problems = missing(statuses);
    problems.insert(problems.begin(), "no rest in " + std::to_string(most_time.count()) + " ms");
    return problems;
}

Problems Round::at_rest(const Statuses& statuses, bool complete)
{
    auto problems = complete ? missing(statuses) : without_reason(statuses);
    std::ranges::move(disagreeing(statuses, running_.born()), std::back_inserter(problems));
    if (auto problem = values_.found(running_.settings()))
        problems.push_back(*problem);
    if (statuses.contains(source))
        if (const auto count = running_.application().get(source, {"count"}).at("count"); count != running_.fed())
            problems.push_back("the source's count is " + count.dump() + "; " + std::to_string(running_.fed())
                               + " was confirmed");
    const auto counts = collecting_.counts();
    // A collector in order learns with the first result whose exceptions it has to hear: it may have missed those of
    // earlier stages, and each of them ends the ways to all ends.
    const auto unheard = model_.failed_early() * static_cast<std::int64_t>(plan_.topology.stages.back().drones.size());
    const auto lost = counts.dropped + std::max<std::int64_t>(counts.missing - unheard, 0);
    if (complete && plan_.topology.demand && !model_.was_excused() && lost > 0)
        problems.push_back("the collector counts " + std::to_string(counts.missing) + " missing and "
                           + std::to_string(counts.dropped) + " dropped");
    return problems;
}

}  // namespace hive::mixtures
