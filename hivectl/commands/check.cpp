// hivectl check: finds the errors in a swarm file.
#include "../verbs.hpp"
#include "run/swarm_file.hpp"

namespace hivectl::check_verb {
namespace {

void print(const std::string& file, const hive::SwarmReading& reading)
{
    for (const auto& mistake : reading.mistakes)
        write_out(mistake_text(file, mistake) + "\n");
    if (reading.mistakes.empty())
        write_out(printable(reading.plan.name) + ": good, " + size_text(reading.plan) + "\n");
}

void print_json(const std::string& file, const hive::SwarmReading& reading)
{
    std::vector<Row> rows;
    for (const auto& mistake : reading.mistakes)
        rows.push_back({{"file", mistake.file.empty() ? file : mistake.file},
                        {"line", mistake.line},
                        {"column", mistake.column},
                        {"at", mistake.at},
                        {"text", mistake.text},
                        {"advice", mistake.advice}});
    write_out(json_array(rows) + "\n");
}

int run(const SwarmInput& input, Session& session)
{
    const auto& file = input.file;
    const auto reading = swarm_reading(input, session.timeout(std::chrono::seconds(10)), true);
    session.json ? print_json(file, reading) : print(file, reading);
    for (const auto& note : reading.notes)
        complain("check", mistake_text(file, note));
    return reading.mistakes.empty() ? exit_code::done : exit_code_of(hive::Errc::invalid_argument);
}

void declare(CommandLine& line, SwarmInput& input)
{
    line.option("FILE", input.file, "the swarm file; -: stdin").required();
    declare_variables(line, input);
}

}  // namespace

Verb verb()
{
    return {.name = "check",
            .group = "a swarm from a file",
            .usage = "FILE [options]",
            .summary = "Checks a swarm file without starting anything",
            .details = "Prints each mistake as FILE:LINE:COLUMN: TEXT for editors, and then exits with 2. Checks "
                       "names, options and references, and for kinds that are installed here also parameters, ranges, "
                       "ports and types. Kinds that are only on other machines are listed on stderr as not checked.",
            .examples = "hivectl check doorway.json",
            .timeout = "how long programs may take to describe themselves (default 10)",
            .operands = {Operand::file},
            .declare = with(declare, run)};
}

}  // namespace hivectl::check_verb
