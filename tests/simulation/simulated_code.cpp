// Code of drones that fails when it is to, and what it is given to work on.
#include "drones.hpp"
#include "simulated_ground.hpp"

#include <stdexcept>

namespace hive::simulation {

using namespace std::chrono_literals;
using mixtures::Failure;

/// Most are small.
std::size_t SimulatedGround::body_size()
{
    constexpr std::uint64_t large = 300 * 1024, small = 2000;
    return world_.chance_of(world_.chance(30) ? large : small);
}

bool SimulatedGround::fails_now(const std::string& drone)
{
    const auto found = failing_.find(drone);
    return found != failing_.end() && --found->second.events == 0;
}

/// In a thread of the drone. What an event gives depends only on the event, however often the code is called for it.
void SimulatedGround::on_work(const std::string& drone, const Event& event)
{
    if (drone == mixtures::watcher)
        return;
    if (const auto wrong = wrong_body(event))
        wrong_bodies_.push_back(*wrong);
    if (!topology_.fails && !failing_.contains(drone))
        return;
    const auto& stage = topology_.stages[topology_.stage_of(drone)];
    const auto& [captured, epoch, sequence] =
        std::tie(event.identity.captured_us, event.identity.epoch, event.identity.sequence);
    const auto [known, fresh] =
        throws_.try_emplace(std::tuple(stage.shared() ? stage.options.group : drone, captured, epoch, sequence), false);
    if (known->second)
        throw std::runtime_error("told to fail");
    if (!fresh || !fails_now(drone))
        return;
    const auto failing = failing_.extract(drone).mapped();
    trace_.line(drone, "fails");
    if (failing.how == Failure::hangs || failing.how == Failure::lingers)
        return world_.spend(failing.time);
    if (failing.how != Failure::crashes) {
        known->second = true;
        throw std::runtime_error("told to fail");
    }
    world_.current()->frozen = true;
    world_.kill(world_.current()->pid);
    world_.sleep(1h);
}

/// Does the code fail at an event that comes in time?
bool SimulatedGround::failed_by(const mixtures::Step& step, Failure how, std::chrono::milliseconds time)
{
    failing_[step.drone] = {1 + world_.chance_of(3), how, time};
    for (const auto last = world_.now() + 200ms; failing_.contains(step.drone) && world_.now() < last;)
        world_.sleep(1ms);
    return failing_.erase(step.drone) == 0;
}

/// If no event comes in time, it is as if the code had failed between two of them.
void SimulatedGround::fail(const mixtures::Step& step)
{
    const auto& drone = step.drone;
    const auto how = static_cast<Failure>(step.second);
    const std::chrono::milliseconds time(step.number);
    auto* const process = running_.at(drone)->process;
    if (how == Failure::halts)
        calls_.keep("policy", [&] { application_->exception_policy(drone, ExceptionPolicy::halt); });
    if (how == Failure::crashes)
        links_.broken(drone, world_.now());
    const bool failed = failed_by(step, how, time);
    if (how == Failure::crashes && failed) {
        until([&] { return process->dead; });
        killed_.insert(drone);
    } else if (how == Failure::crashes) {
        kill(drone);
    }
    if (how != Failure::halts)
        return;
    if (!failed)
        calls_.keep("halt", [&] { application_->halt(drone); });
    calls_.keep("policy", [&] { application_->exception_policy(drone, ExceptionPolicy::skip); });
}

}  // namespace hive::simulation
