// Reads swarm files for verbs, and prints their errors.
#include "run/swarm_file.hpp"

#include "run/command_line.hpp"
#include "words/file_text.hpp"
#include "words/output.hpp"
#include "words/settings.hpp"
#include "words/status_line.hpp"

#include <hive/printable.hpp>

#include <set>

namespace hivectl {
namespace {

constexpr std::size_t most_bytes = 16 << 20;  // the limit of the reader

std::string counted(std::size_t number, const std::string& what)
{
    return std::to_string(number) + " " + what + (number == 1 ? "" : "s");
}

}  // namespace

Option declare_variables(CommandLine& line, SwarmInput& input)
{
    return line.option("--set", input.settings, "the value of a variable of the file; may be repeated")
        .type_name("NAME=VALUE")
        .one_each();
}

hive::SwarmReading swarm_reading(const SwarmInput& input, std::chrono::milliseconds limit, bool to_be_started)
{
    const auto folder = input.file == "-" ? std::filesystem::path() : std::filesystem::path(input.file).parent_path();
    hive::SwarmContext context{
        .folder = folder.empty() ? "." : folder, .variables = {}, .to_be_started = to_be_started};
    const auto settings = parse_settings(input.settings);
    for (const auto& [name, value] : settings.items())
        context.variables[name] = value.get<std::string>();
    const Waiting waiting("the programs of the drones to describe themselves");
    return hive::check_swarm(text_of_file(input.file, most_bytes), limit, context);
}

std::string mistake_text(const std::string& file, const hive::Mistake& mistake)
{
    const auto& name = mistake.file.empty() ? file : mistake.file;
    return hive::printable((name == "-" ? "<stdin>" : name) + ":" + std::to_string(mistake.line) + ":"
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

std::optional<hive::SwarmPlan> read_plan(std::string_view verb, const SwarmInput& input, bool to_be_started)
{
    auto reading = swarm_reading(input, std::chrono::seconds(10), to_be_started);
    for (const auto& mistake : reading.mistakes)
        fail(verb, hive::Errc::invalid_argument, mistake_text(input.file, mistake));
    if (!reading.mistakes.empty())
        return std::nullopt;
    return std::move(reading.plan);
}

}  // namespace hivectl
