// Namespaces, signals, hivectl and the calls of an application.
#include "machines.hpp"

#include <checks.hpp>
#include <orders.hpp>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <future>
#include <stdexcept>

namespace hive::soak {
namespace {

using namespace std::chrono_literals;
using namespace mixtures;

const std::vector<std::string> machines{"cam1", "gpu1", "gpu2"};

/// A twin switches defences off in the drones.
std::vector<std::string> variables()
{
    const char* without = std::getenv("HIVE_TEST_WITHOUT");
    return without ? std::vector{"HIVE_TEST_WITHOUT=" + std::string(without)} : std::vector<std::string>{};
}

}  // namespace

bool runs(pid_t pid)
{
    const auto stat = test::text_of("/proc/" + std::to_string(pid) + "/stat");
    const auto name_end = stat.rfind(')');
    return name_end != std::string::npos && stat.size() > name_end + 2 && stat[name_end + 2] != 'Z';
}

Machines::Machines(const Swarm& swarm) : swarm_(swarm), lab_(machines, variables()), on_laptop_(lab_.laptop_network())
{
    lab_.share_key();
    const auto home = lab_.laptop().home();
    ::setenv("DBUS_SYSTEM_BUS_ADDRESS", ("unix:path=" + (home / "bus").string()).c_str(), 1);
    ::setenv("HIVE_KEY", (lab_.directory() / ".config/hive/swarm.key").c_str(), 1);
    for (std::size_t i = 0; i < machines.size(); ++i)
        local_.push_back(std::make_unique<Application>(
            Application::Options{.name = {}, .home = lab_.machine(i).swarm.home(), .timeout = 20s}));
    application_ = std::make_unique<Application>(Application::Options{.name = {}, .home = home, .timeout = 20s});
    for (const auto& drone : swarm_.topology.drones()) {
        start(drone, false);
        born_[drone] = 0;
    }
    collecting_.emplace(lab_.laptop(), swarm_.topology);
}

/// Looks follow each other more slowly than in a small round: there are other processes on this machine.
void Machines::sleep(std::chrono::microseconds time)
{
    std::this_thread::sleep_for(time < 20ms ? time : std::chrono::microseconds(80ms));
}

void Machines::at_once(const std::function<void()>& one, const std::function<void()>& other)
{
    auto beside = std::async(std::launch::async, one);
    other();
    beside.get();
}

bool Machines::all_hear() const { return network_failures_ == 0 && now() - network_whole_ > 5s; }

std::size_t Machines::number_of(const std::string& machine)
{
    return static_cast<std::size_t>(std::ranges::find(machines, machine) - machines.begin());
}

std::vector<std::string> Machines::answering() const
{
    auto names = swarm_.topology.drones();
    std::erase_if(names, [&](const auto& drone) { return !pids_.contains(drone) || frozen_.contains(drone); });
    return names;
}

Statuses Machines::statuses()
{
    Statuses all;
    for (std::size_t machine = 0; machine < machines.size(); ++machine) {
        auto drones = answering();
        std::erase_if(drones, [&](const auto& drone) { return machine_of(drone) != machine; });
        all.merge(statuses_of(*local_[machine], drones));
    }
    return all;
}

Settings Machines::settings()
{
    Settings all;
    for (const auto& drone : answering())
        if (drone != source)
            all.merge(settings_of(local(drone), {drone}));
    return all;
}

std::int64_t Machines::count() { return local(source).get(source, {"count"}).at("count"); }

std::vector<Outcome> Machines::outcomes()
{
    auto outcomes = collecting_->take();
    for (const auto& outcome : outcomes) {
        ++(outcome.failed ? came_.exceptions : came_.results);
        newest_[outcome.epoch] = std::max(newest_[outcome.epoch], outcome.sequence);
        if (outcome.failed)
            ++(outcome.text.starts_with("abandoned") ? came_.given_up : came_.failures)[outcome.sender];
    }
    return outcomes;
}

std::vector<std::string> Machines::fallen()
{
    std::vector<std::string> fallen;
    for (const auto& [drone, pid] : pids_)
        if (!runs(pid))
            fallen.push_back(drone + " has ended by itself:\n" + lab_.machine(machine_of(drone)).swarm.log(drone));
    return fallen;
}

std::vector<std::string> Machines::end()
{
    std::vector<std::string> left;
    lab_.hivectl_done("stop --all --timeout 30");
    for (const auto& row : pids_)
        if (!test::eventually([&] { return !runs(row.second); }))
            left.push_back(row.first + " still runs after stop");
    return left;
}

Usages Machines::usages() const
{
    Usages usages;
    for (const auto& [drone, pid] : pids_)
        usages[drone] = {.memory = static_cast<std::int64_t>(test::resident_bytes(pid)),
                         .descriptors = static_cast<std::int64_t>(test::open_descriptors(pid))};
    return usages;
}

void Machines::save_logs(const std::filesystem::path& directory) const
{
    namespace fs = std::filesystem;
    const auto copy = [&](const fs::path& home, const std::string& machine) {
        fs::create_directories(directory / machine);
        for (const auto& entry : fs::directory_iterator(home))
            if (entry.path().string().find(".log") != std::string::npos && entry.is_regular_file())
                fs::copy(entry.path(), directory / machine, fs::copy_options::overwrite_existing);
    };
    for (std::size_t i = 0; i < machines.size(); ++i)
        copy(lab_.machine(i).swarm.home(), machines[i]);
    copy(lab_.laptop().home(), "laptop");
}

}  // namespace hive::soak
