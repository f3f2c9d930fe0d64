// Sentences about swarm files.
#include "swarm_file.hpp"

#include "file_text.hpp"
#include "output.hpp"
#include "status_line.hpp"

#include <hive/printable.hpp>

#include <set>

namespace hivectl {
namespace {

constexpr std::size_t most_bytes = 16 << 20;  // the reader takes no more

std::string counted(std::size_t number, const std::string& what)
{
    return std::to_string(number) + " " + what + (number == 1 ? "" : "s");
}

}  // namespace

std::string swarm_text(const std::string& file) { return text_of_file(file, most_bytes); }

std::string mistake_text(const std::string& file, const hive::Mistake& mistake)
{
    return hive::printable((file == "-" ? "<stdin>" : file) + ":" + std::to_string(mistake.line) + ":"
                           + std::to_string(mistake.column) + ": " + mistake.text
                           + (mistake.advice.empty() ? "" : "; " + mistake.advice));
}

std::string size_text(const hive::SwarmPlan& plan)
{
    std::set<std::string> machines;
    for (const auto& drone : plan.drones)
        machines.insert(drone.host);
    return counted(plan.drones.size(), "drone") + " on " + counted(machines.size(), "machine") + ", "
           + counted(plan.connections.size(), "connection");
}

std::optional<hive::SwarmPlan> read_plan(std::string_view verb, const std::string& file)
{
    std::optional<Waiting> waiting("the programs of the drones to describe themselves");
    auto reading = hive::check_swarm(swarm_text(file), std::chrono::seconds(10));
    waiting.reset();
    for (const auto& mistake : reading.mistakes)
        complain(verb, mistake_text(file, mistake));
    if (!reading.mistakes.empty())
        return std::nullopt;
    return std::move(reading.plan);
}

}  // namespace hivectl
