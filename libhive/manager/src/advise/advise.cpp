// Measures and predicts, and writes the results as JSON.
#include "commands.hpp"

#include <array>
#include <cmath>

namespace hive {
namespace advising {
namespace {

AdvisedLine advised(Application& application, const Measured& measured, Goal goal)
{
    const auto& line = measured.line;
    AdvisedLine result{.from = names(line.stages.front()),
                       .to = names(line.last()),
                       .per_s = line.per_s(),
                       .latency_us = measured_latency(line).value_or(0),
                       .stations = stations(line),
                       .limits = explains_rate(line) ? limits(line) : std::vector<Station>()};
    for (auto& candidate : candidates(line, goal))
        try {
            complete(application, measured, candidate);
            result.proposals.push_back(std::move(candidate.proposal));
        } catch (const Error&) {
            // A drone that does not report the options for a further one.
        }
    return result;
}

double rounded(double number) { return std::round(number * 100) / 100; }

Json station_json(const Station& station)
{
    return {{"what", token(station.what)},
            {"at", station.at},
            {"time_us", std::llround(station.time_us)},
            {"max_per_s", rounded(station.max_per_s)}};
}

Json stations_json(const std::vector<Station>& stations)
{
    Json array = Json::array();
    for (const auto& station : stations)
        array.push_back(station_json(station));
    return array;
}

Json proposal_json(const Proposal& proposal)
{
    return {{"what", token(proposal.what)},
            {"text", proposal.text},
            {"command", proposal.command},
            {"predicted_per_s", rounded(proposal.predicted_per_s)},
            {"predicted_us", std::llround(proposal.predicted_us)},
            {"next", proposal.next ? station_json(*proposal.next) : Json()},
            {"sure", token(proposal.sure)},
            {"unsure", proposal.unsure}};
}

Json line_json(const AdvisedLine& line)
{
    Json proposals = Json::array();
    for (const auto& proposal : line.proposals)
        proposals.push_back(proposal_json(proposal));
    return {{"from", line.from},
            {"to", line.to},
            {"per_s", rounded(line.per_s)},
            {"latency_us", std::llround(line.latency_us)},
            {"stations", stations_json(line.stations)},
            {"limits", stations_json(line.limits)},
            {"proposals", proposals}};
}

template <class Enum, std::size_t count>
std::string_view token_of(const std::array<std::string_view, count>& tokens, Enum value)
{
    return tokens.at(static_cast<std::size_t>(value));
}

using std::string_view_literals::operator""sv;
constexpr std::array goals{"fps"sv, "latency"sv};
constexpr std::array station_tokens{"source"sv, "waiting"sv, "encoding"sv, "travel"sv,
                                    "queue"sv,  "work"sv,    "window"sv,   "processors"sv};
constexpr std::array proposal_tokens{"worker"sv,      "window"sv, "encoding"sv, "transfer"sv,
                                     "source_rate"sv, "halt"sv,   "machine"sv};
constexpr std::array sure_tokens{"low"sv, "medium"sv, "high"sv};

}  // namespace
}  // namespace advising

std::string_view token(Goal goal) noexcept { return advising::token_of(advising::goals, goal); }
std::string_view token(Station::What what) noexcept { return advising::token_of(advising::station_tokens, what); }
std::string_view token(Proposal::What what) noexcept { return advising::token_of(advising::proposal_tokens, what); }
std::string_view token(Proposal::Sure sure) noexcept { return advising::token_of(advising::sure_tokens, sure); }

Advice advise(Application& application, const std::vector<std::string>& drones, const AdviceOptions& options)
{
    if (drones.size() > 2)
        throw Error(Errc::invalid_argument, "advise takes the last drone of a pipeline, or the first and the last",
                    "for all lines: hivectl advise");
    Advice advice{.goal = options.goal, .lines = {}};
    for (const auto& measured : advising::measure(application, drones, options.time))
        advice.lines.push_back(advising::advised(application, measured, options.goal));
    return advice;
}

Json to_json(const Advice& advice)
{
    Json lines = Json::array();
    for (const auto& line : advice.lines)
        lines.push_back(advising::line_json(line));
    return {{"goal", token(advice.goal)}, {"lines", lines}};
}

}  // namespace hive
