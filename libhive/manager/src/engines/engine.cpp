// Creates engines by name, and stops drones of several.
#include "engine.hpp"

#include "systemd_unit.hpp"

#include <hive/protocol/connect_text.hpp>

#include <algorithm>
#include <future>
#include <iterator>

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
        throw systemd_refused(host);
    if (engine.name == "systemd")
        return make_systemd_engine(home);
    throw Error(Errc::unsupported, "there is no engine " + engine.name + " for " + host);
}

std::vector<std::string> with_order(std::vector<std::string> command, const SwarmDrone& drone)
{
    const auto program = arguments_of(drone);
    std::copy_if(program.begin() + 2, program.end(), std::back_inserter(command),  // after --name NAME
                 [](const std::string& word) { return word != "--set"; });
    return command;
}

std::string restart_word(Restart restart, const std::string& never)
{
    return restart == Restart::always ? "always" : restart == Restart::on_failure ? "on-failure" : never;
}

std::string doubled(const std::string& text, char character)
{
    std::string result;
    for (const char c : text)
        result += std::string(c == character ? 2 : 1, c);
    return result;
}

std::string hex_escape(char byte)
{
    constexpr std::string_view digits = "0123456789abcdef";
    const auto number = static_cast<unsigned char>(byte);
    return {'\\', 'x', digits[number / 16], digits[number % 16]};
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

}  // namespace hive
