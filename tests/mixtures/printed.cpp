#include "printed.hpp"

#include <sstream>

namespace hive::mixtures {
namespace {

constexpr int done = 0, partly_done = 8;

int lines_of(const Printed& printed, std::int64_t epoch, std::int64_t sequence)
{
    const auto found = printed.results.find({epoch, sequence});
    return found == printed.results.end() ? 0 : found->second;
}

std::string to_text(const Printed& printed)
{
    return "hivectl results exited with " + std::to_string(printed.exit_code)
           + (printed.complaints.empty() ? "" : ":\n" + printed.complaints);
}

}  // namespace

Printed printed_in(const std::string& log, int exit_code)
{
    Printed printed{.exit_code = exit_code, .complaints = {}};
    std::istringstream lines(log);
    for (std::string line; std::getline(lines, line);) {
        const auto result = Json::parse(line, nullptr, false);
        if (result.is_object())
            ++printed.results[{result.at("epoch"), result.at("seq")}];
        else
            printed.complaints += line + "\n";
    }
    return printed;
}

Problems wrongly_printed(const Printed& printed, const Model& model, const LastRun& run)
{
    Problems problems;
    for (const auto& [event, lines] : printed.results)
        if (lines > model.max_results())
            problems.push_back("command: event " + std::to_string(event.second) + " (epoch "
                               + std::to_string(event.first) + ") was printed " + std::to_string(lines)
                               + " times, and has at most " + std::to_string(model.max_results()) + " results");
    if (printed.exit_code != done && printed.exit_code != partly_done)
        problems.push_back("command: " + to_text(printed));
    bool complete = true;
    for (std::int64_t sequence = 1; run.lossless && sequence <= run.produced; ++sequence) {
        const auto lines = lines_of(printed, run.epoch, sequence);
        complete = complete && lines == model.max_results();
        if (const auto owed = model.results_owed(run.epoch, sequence); printed.exit_code == done && lines < owed)
            problems.push_back("command: event " + std::to_string(sequence) + " was printed " + std::to_string(lines)
                               + " times and collected " + std::to_string(owed) + " times, and " + to_text(printed));
    }
    if (run.lossless && run.first && complete && !model.any_failed() && printed.exit_code == partly_done)
        problems.push_back("command: every result was printed once, and " + to_text(printed));
    return problems;
}

}  // namespace hive::mixtures
