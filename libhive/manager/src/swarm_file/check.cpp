// Checking a swarm file with the interfaces of the programs that are on this machine.
#include <hive/program.hpp>
#include <hive/swarm_plan.hpp>

#include <algorithm>
#include <atomic>
#include <set>
#include <thread>
#include <variant>

namespace hive {
namespace {

using Told = std::variant<std::monostate, Interface, Error>;

/// Asks the programs of the kinds, a few at a time.
std::vector<Told> ask_programs(const std::vector<std::string>& kinds_of_file, std::chrono::milliseconds limit)
{
    constexpr std::size_t at_once = 8;
    const auto end = std::chrono::steady_clock::now() + limit;
    std::vector<Told> told(kinds_of_file.size());
    std::atomic<std::size_t> next = 0;
    const auto ask = [&] {
        for (std::size_t i = next++; i < told.size(); i = next++)
            try {
                const auto left = end - std::chrono::steady_clock::now();
                told[i] = interface_of(kinds_of_file[i], std::chrono::ceil<std::chrono::milliseconds>(left));
            } catch (...) {
                told[i] = current_error();
            }
    };
    std::vector<std::jthread> askers;
    for (std::size_t i = 0; i < std::min(at_once, told.size()); ++i)
        askers.emplace_back(ask);
    askers.clear();  // waits for them
    return told;
}

}  // namespace

SwarmReading check_swarm(std::string_view text, std::chrono::milliseconds limit)
{
    std::set<std::string> found;
    for (const auto& drone : read_swarm(text).plan.drones)
        if (!drone.kind.empty())
            found.insert(drone.kind);
    const std::vector<std::string> kinds_of_file(found.begin(), found.end());
    const auto told = ask_programs(kinds_of_file, limit);
    return read_swarm(text, [&](const std::string& kind) {
        const auto place = std::ranges::lower_bound(kinds_of_file, kind);
        const auto at = static_cast<std::size_t>(place - kinds_of_file.begin());
        if (const auto* error = std::get_if<Error>(&told.at(at)))
            throw *error;
        return std::get<Interface>(told.at(at));
    });
}

}  // namespace hive
