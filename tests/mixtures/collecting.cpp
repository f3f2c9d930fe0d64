// Results and exceptions, taken by one thread because an application is for one thread.
#include "collecting.hpp"

namespace hive::mixtures {
namespace {

using namespace std::chrono_literals;

std::vector<Endpoint> last_outputs(const Topology& topology)
{
    std::vector<Endpoint> ends;
    for (const auto& drone : topology.stages.back().drones)
        ends.push_back({drone, Topology::output_of(drone)});
    return ends;
}

}  // namespace

Collecting::Collecting(const test::Swarm& swarm, const Topology& topology)
    : application_({.name = "collector", .home = swarm.home(), .timeout = test::stated(5000ms)}),
      hearing_({.name = hearer, .home = swarm.home(), .timeout = test::stated(5000ms)}),
      results_(application_.collect(last_outputs(topology), {.ordered = topology.ordered})),
      exceptions_(hearing_.exceptions(topology.drones())),
      thread_([this](const std::stop_token& ending) { run(ending); })
{
}

void Collecting::run(const std::stop_token& ending)
{
    while (!ending.stop_requested()) {
        const auto result = results_->next(5ms);
        const auto exception = exceptions_->next(results_->ended() ? 5ms : 0ms);  // one of the two waits
        const std::lock_guard lock(mutex_);
        if (result)
            came_.push_back(outcome_of(*result, false));
        if (exception && exception->identity.sequence > 0)
            came_.push_back(outcome_of(*exception, true));
        counts_ = results_->counts();
        ended_ = results_->ended();
    }
}

std::vector<Outcome> Collecting::take()
{
    const std::lock_guard lock(mutex_);
    return std::exchange(came_, {});
}

CollectCounts Collecting::counts() const
{
    const std::lock_guard lock(mutex_);
    return counts_;
}

std::optional<std::string> Collecting::ended() const
{
    const std::lock_guard lock(mutex_);
    return ended_;
}

}  // namespace hive::mixtures
