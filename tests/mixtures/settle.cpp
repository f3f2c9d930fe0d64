// Waiting until nothing changes any more, and what must hold then.
#include "round.hpp"

#include <algorithm>

namespace hive::mixtures {
namespace {

using namespace std::chrono_literals;

/// So long nothing has changed when it counts as standing still.
constexpr auto still_time = test::sanitized() ? 3000ms : 1100ms;
/// Places are kept for 30 s, and so long an ordered collector waits.
constexpr auto most_time = test::patient(45'000ms);

/// Since when has a picture been the same?
class Stillness {
public:
    void look(Json picture)
    {
        if (picture == picture_)
            return;
        picture_ = std::move(picture);
        since_ = test::Clock::now();
    }
    [[nodiscard]] bool still() const { return test::Clock::now() - since_ >= still_time; }

private:
    Json picture_;
    test::Clock::time_point since_ = test::Clock::now();
};

}  // namespace

bool Round::source_done(const Statuses& statuses) const
{
    const auto found = statuses.find(source);
    return found != statuses.end() && found->second.outputs.at(0).produced >= running_.fed();
}

/// Are all edges of a drone ("": of all) there?
bool Round::whole(const Statuses& statuses, const std::string& drone) const
{
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

Problems Round::settle(bool last)
{
    Stillness drones, source_alone;
    for (const auto end = test::Clock::now() + most_time;; std::this_thread::sleep_for(10ms)) {
        const auto statuses = running_.statuses();
        listen();
        end_excuses(statuses);
        auto problems = unbalanced(statuses);
        if (!problems.empty() || !problems_.empty())
            return problems;
        const bool complete = statuses.size() == running_.answering().size();
        const bool at_end = complete && idle(statuses) && source_done(statuses);
        drones.look(complete ? still_picture(statuses) : Json(std::rand()));
        if (const auto found = statuses.find(source); found != statuses.end()) {
            source_alone.look({found->second.epoch, found->second.outputs.at(0).produced});
            if (source_alone.still() && plan_.topology.demand && !source_done(statuses) && !says_why(found->second))
                return {"the source has not moved for " + std::to_string(still_time.count())
                        + " ms and does not say why"};
        }
        if (at_end && (!last || whole(statuses, "")) && missing(statuses).empty())
            return at_rest(statuses, true);
        if (drones.still() && !at_end && !last)
            return at_rest(statuses, false);
        if (test::Clock::now() > end || (drones.still() && at_end && !plan_.topology.ordered))
            return at_end ? at_rest(statuses, true)
                          : Problems{"no rest in " + std::to_string(most_time.count()) + " ms"};
    }
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
    if (complete && plan_.topology.demand && !model_.was_excused() && counts.missing + counts.dropped > 0)
        problems.push_back("the collector counts " + std::to_string(counts.missing) + " missing and "
                           + std::to_string(counts.dropped) + " dropped");
    return problems;
}

}  // namespace hive::mixtures
