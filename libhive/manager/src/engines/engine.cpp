// Creates engines by name, and writes the options common to all of them.
#include "engine.hpp"

#include <hive/program.hpp>
#include <hive/protocol/connect_text.hpp>

#include <algorithm>
#include <future>
#include <iterator>

#include <sys/wait.h>

namespace hive {

namespace {

std::vector<SwarmFailure> stopped(Engine& engine, const std::vector<std::string>& drones,
                                  Engine::Clock::time_point until)
try {
    return engine.stop(drones, until);
} catch (const Error& error) {
    std::vector<SwarmFailure> remains;
    for (const auto& drone : drones)
        remains.push_back({drone, error});
    return remains;
}

}  // namespace

std::vector<SwarmFailure> stop_all(const std::map<Engine*, std::vector<std::string>>& drones,
                                   Engine::Clock::time_point until)
{
    std::vector<std::future<std::vector<SwarmFailure>>> stops;
    for (const auto& row : drones)
        stops.push_back(
            std::async(std::launch::async, [&row, until] { return stopped(*row.first, row.second, until); }));
    std::vector<SwarmFailure> remains;
    for (auto& stop : stops)
        std::ranges::move(stop.get(), std::back_inserter(remains));
    return remains;
}

std::unique_ptr<Engine> make_engine(const SwarmEngine& engine, const std::string& host,
                                    const std::filesystem::path& home)
{
    if (engine.name == "local")
        return make_local_engine(home);
    if (engine.name == "ssh")
        return make_ssh_engine(engine.settings, home);
    if (engine.name == "slurm")
        return make_slurm_engine(engine.settings, host, home);
    if (engine.name == "systemd" && host != Place::here)
        throw Error(Errc::unsupported, "systemd starts drones of this machine, and not of " + host,
                    "leave that engine out, or have units written for each machine: hivectl export --as systemd");
    if (engine.name == "systemd")
        return make_systemd_engine(home);
    throw Error(Errc::unsupported, "there is no engine " + engine.name + " for " + host);
}

Errc errc_of_exit(int code)
{
    for (const auto error : {Errc::invalid_argument, Errc::not_found, Errc::unreachable, Errc::refused,
                             Errc::type_mismatch, Errc::halted, Errc::timeout})
        if (info(error).exit_code == code)
            return error;
    return Errc::failed;
}

Errc errc_of_status(int status) { return WIFEXITED(status) ? errc_of_exit(WEXITSTATUS(status)) : Errc::failed; }

std::string log_text(const std::string& last_words)
{
    const auto end = last_words.find_last_not_of('\n') + 1;
    return "its log says:\n" + (end == 0 ? "(nothing)" : last_words.substr(0, end));
}

std::string subject_of(const SwarmDrone& drone) { return (takes_over(drone) ? "the successor of " : "") + drone.name; }

Error not_ready(const std::string& drone, int status, const std::string& last_words)
{
    return {errc_of_status(status), drone + " " + how_its_start_ended(status) + "; " + log_text(last_words)};
}

SwarmDrone as_started(const SwarmPlan& plan, SwarmDrone drone)
{
    if (drone.swarm.empty())  // else another swarm owned it before the restart, and still does
        drone.swarm = plan.name;
    for (const auto& [from, to, options] : plan.connections)
        if (from.drone == drone.name && !from.port.empty() && !to.port.empty() && options.delivery == Delivery::data)
            drone.expected.push_back(protocol::to_text(
                protocol::Expect{.output = from.port, .receiver = to.drone + "." + to.port, .group = options.group}));
    return drone;
}

std::vector<std::string> arguments_of(const SwarmDrone& drone)
{
    std::vector<std::string> words{"--name", drone.name};
    for (const auto& [name, value] : drone.set.items())
        words.insert(words.end(), {"--set", assignment(name, value)});
    std::ranges::move(option_words(drone), std::back_inserter(words));
    if (!drone.swarm.empty())
        words.insert(words.end(), {"--swarm", drone.swarm});
    if (takes_over(drone))
        words.insert(words.end(), {"--take-over", std::to_string(drone.take_over_s)});
    for (const auto& connection : drone.connections)
        words.insert(words.end(), {"--connect", connection});
    for (const auto& receiver : drone.expected)
        words.insert(words.end(), {"--expect", receiver});
    return words;
}

}  // namespace hive
