// Replaces simulated drones with the code of hivectl replace, while a process is killed or another order reaches them.
#include "programs.hpp"
#include "simulated_ground.hpp"

#include <hive/start.hpp>

#include <algorithm>

namespace hive::simulation {

using namespace std::chrono_literals;
using mixtures::Meanwhile;
using mixtures::Step;

namespace {

std::string other(const std::string& kind)
{
    return kind.ends_with("-2") ? kind.substr(0, kind.size() - 2) : kind + "-2";
}

}  // namespace

/// In the end one process has the name: whatever is killed meanwhile, what is not there then is started again.
void SimulatedGround::replace(const Step& step)
{
    const auto meanwhile = static_cast<Meanwhile>(step.second);
    const bool kills =
        meanwhile == Meanwhile::kill_old || meanwhile == Meanwhile::kill_new || meanwhile == Meanwhile::kill_caller;
    auto* const old = running_.at(step.drone)->process;
    std::vector<std::string> drones{step.drone};
    if (!step.sender.empty())
        drones.push_back(step.sender);
    std::vector<Process*> callers;
    for (const auto& drone : drones) {
        links_.broken(drone, world_.now());
        const auto kind = running_.at(drone)->drone->status().kind;
        callers.push_back(&replace_in_background(drone, meanwhile == Meanwhile::other_kind ? other(kind) : ""));
    }
    if (kills || meanwhile == Meanwhile::twice)
        world_.sleep(std::chrono::milliseconds(step.number));
    if (meanwhile == Meanwhile::twice)
        callers.push_back(&replace_in_background(step.drone));
    else if (meanwhile == Meanwhile::kill_old)
        world_.kill(*old);
    else if (meanwhile == Meanwhile::kill_caller)
        world_.kill(*callers.front());
    else if (meanwhile == Meanwhile::kill_new && !successors_.empty())
        world_.kill(*successors_.back().second->process);
    replaces_.keep("replace", [&] {
        until([&] { return std::ranges::all_of(callers, [](const Process* each) { return each->dead; }); });
        await_successors();
    });
    const bool done = std::ranges::any_of(callers, [](const Process* each) { return each->failure.empty(); });
    for (const auto& drone : drones) {
        if (running_.at(drone)->process->dead && kills)
            start(drone, true);
        links_.mended(drone, world_.now());
    }
    if (!done && !kills)
        throw Error(Errc::failed, callers.front()->failure);
}

Process& SimulatedGround::replace_in_background(const std::string& drone, const std::string& kind)
{
    const auto name = "replacer-" + std::to_string(++callers_);
    return world_.spawn(name, [this, name, drone, kind] {
        Application application(application_named(name));
        StartOptions options;
        options.drone.name = drone;
        options.drone.kind = kind;
        try {
            static_cast<void>(hive::replace(application, options));
        } catch (const Error& error) {
            trace_.line(name, error.what());
            throw;
        }
    });
}

/// Those that have asked for the name, but do not have it yet.
void SimulatedGround::await_successors()
{
    until([this] {
        return std::ranges::all_of(successors_, [this](const auto& each) {
            const auto& [drone, successor] = each;
            return successor->process->dead || running_.at(drone) == successor;
        });
    });
    successors_.clear();
}

/// In a process of its own.
Process& SimulatedGround::start_program(const std::vector<std::string>& words)
{
    const auto name = *(std::ranges::find(words, "--name") + 1);
    const auto successor = std::make_shared<Running>();
    auto& process = world_.spawn(name, [this, words, name, successor] {
        std::vector<const char*> arguments;
        for (const auto& word : words)
            arguments.push_back(word.c_str());
        int exit_code = 0;
        const auto embedded = EmbeddedDrone::from_command_line(static_cast<int>(arguments.size()), arguments.data(),
                                                               {words.front(), "of a simulated round"}, exit_code);
        live(name, *embedded, successor);
    });
    process.machine = machine_of(name);
    process.log = [log = log_of(name, successor)](const std::string& text) { log(LogLevel::info, text); };
    successor->process = &process;
    successors_.emplace_back(name, successor);
    return process;
}

/// owner: a process gets the name of a drone only when the one before has given it up.
void SimulatedGround::took_name(const std::string& drone, const RunningPtr& running)
{
    auto& owner = running_[drone];
    if (owner == running)
        return;
    if (owner && !owner->process->dead && !owner->stopped)
        wrong_owners_.push_back("owner: process " + std::to_string(running->process->pid) + " took the name " + drone
                                + ", which process " + std::to_string(owner->process->pid) + " still has");
    owner = running;
    born_[drone] = ++starts_;
}

}  // namespace hive::simulation
