// Reconnects with other options; starts a further member with the options and connections of the first.
#include "commands.hpp"

#include "../directory.hpp"
#include "../swarm/running_plan.hpp"
#include "../writers/shell.hpp"

#include <hive/duration_text.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace hive::advising {
namespace {

/// "19.9"
std::string tenths(double number)
{
    const auto rounded = std::llround(number * 10);
    return std::to_string(rounded / 10) + "." + std::to_string(rounded % 10);
}

std::string joined(const std::vector<std::string>& lines)
{
    std::string text;
    for (const auto& line : lines)
        text += (text.empty() ? "" : " && ") + line;
    return text;
}

/// Each member, connected again with other options.
std::string reconnected(const Stage& stage, const ConnectionOptions& options)
{
    std::vector<std::string> lines;
    for (const auto& member : stage.members)
        lines.push_back(connect_line({parse_endpoint(stage.from), {member, parse_endpoint(stage.to).port}, options}));
    return joined(lines);
}

/// The next unused name: "face-2" after "face" or "face-1".
std::string free_name(Application& application, const std::string& member)
{
    const auto used = application.drones();
    auto base = drone_of(member);
    if (const auto dash = base.find_last_not_of("0123456789");
        dash != std::string::npos && dash > 0 && base[dash] == '-')
        base.resize(dash);
    for (int number = 2;; ++number)
        if (auto name = base + "-" + std::to_string(number); std::ranges::find(used, name) == used.end())
            return name;
}

/// Removes the port, which belongs to the drone of the order.
std::string without_port(const std::string& address)
{
    const auto colon = address.rfind(':'), bracket = address.rfind(']');
    const bool has_port =
        colon != std::string::npos && colon > address.find("//") && (bracket == std::string::npos || colon > bracket);
    return has_port ? address.substr(0, colon) : address;
}

/// An unused group name at that output: "face", or "face-2".
std::string free_group(const Status& sender, const std::string& wanted)
{
    std::set<std::string> used;
    for (const auto& output : sender.outputs)
        for (const auto& edge : output.edges)
            used.insert(edge.receiver);
    auto group = wanted;
    for (int number = 2; used.contains("group " + group); ++number)
        group = wanted + "-" + std::to_string(number);
    return group;
}

std::string further_member(Application& application, const Measured& measured, const Change& change)
{
    const auto& stage = measured.line.stages[change.stage];
    std::vector<std::string> drones = stage.members;
    drones.push_back(parse_endpoint(stage.from).drone);
    const auto is_member = [&](const std::string& drone) {
        return std::ranges::find(stage.members, drone) != stage.members.end();
    };
    for (const auto& answer : application.status(application.drones()))
        if (const auto* status = value_of(answer.status);
            status && std::ranges::any_of(status->inputs, [&](const InputStatus& input) {
                return is_member(parse_endpoint(input.from).drone);
            }))
            drones.push_back(answer.drone);
    auto plan = swarm::running_plan(application, "advice", drones);
    plan.name.clear();  // it belongs to the swarm of the first member, if any
    const auto first = drone_of(stage.members.front());
    auto added = *plan.drone(first);
    added.name = free_name(application, first);
    added.listen = without_port(added.listen);
    added.advertise = without_port(added.advertise);
    if (change.what == Proposal::What::machine) {
        added.host = change.name;
        plan.engines.emplace_back(change.name, SwarmEngine{"ssh", measured.line.machines.at(change.name).ssh});
    }
    const auto group = free_group(application.status(parse_endpoint(stage.from).drone), first);
    std::vector<std::string> lines{start_line(plan, added)};
    for (auto connection : plan.connections) {
        const bool receives = std::ranges::find(stage.members, connection.to.drone) != stage.members.end()
                              && connection.from.drone == drone_of(parse_endpoint(stage.from).drone);
        if (receives && connection.options.group.empty()) {
            connection.options.group = group;
            connection.options.first_frame = false;
            lines.push_back(connect_line(connection));
        }
        if (receives && connection.to.drone == first)
            connection.to.drone = added.name;
        else if (connection.from.drone == first)
            connection.from.drone = added.name;
        else
            continue;
        lines.push_back(connect_line(connection));
    }
    return joined(lines);
}

std::string command(Application& application, const Measured& measured, const Change& change)
{
    const auto& stage = measured.line.stages[change.stage];
    auto options = stage.options;
    switch (change.what) {
    case Proposal::What::worker:
    case Proposal::What::machine: return further_member(application, measured, change);
    case Proposal::What::window: options.window = change.window; return reconnected(stage, options);
    case Proposal::What::transfer:
        options.transfer = Transfer::synchronized;
        options.window = 1;
        return reconnected(stage, options);
    case Proposal::What::encoding: options.encoding = change.encoding; return reconnected(stage, options);
    case Proposal::What::source_rate:
        return "hivectl set " + stage.members.front() + " " + measured.line.rate_parameter + "="
               + to_text(Json(measured.line.rate_step == 1 ? Json(std::llround(change.fps)) : Json(change.fps)));
    case Proposal::What::halt: return "hivectl halt " + change.name;
    }
    return {};
}

std::string text(const Line& line, const Change& change)
{
    const auto& stage = line.stages[change.stage];
    switch (change.what) {
    case Proposal::What::worker: return "one more drone that shares the work of " + names(stage);
    case Proposal::What::machine:
        return "one more drone on " + change.name + " that shares the work of " + names(stage);
    case Proposal::What::window:
        return "a window of " + std::to_string(change.window) + " instead of " + std::to_string(stage.options.window)
               + " at " + connection(stage);
    case Proposal::What::transfer: return "the newest event on request instead of each event, at " + connection(stage);
    case Proposal::What::encoding:
        return (change.encoding == "raw" ? std::string("no encoding") : change.encoding) + " at " + connection(stage);
    case Proposal::What::source_rate:
        return "a lower rate of " + names(stage) + ", " + tenths(change.fps) + " per second";
    case Proposal::What::halt: return "the processors without " + change.name;
    }
    return {};
}

}  // namespace

void complete(Application& application, const Measured& measured, Candidate& candidate)
{
    candidate.proposal.text = text(measured.line, candidate.change);
    candidate.proposal.command = command(application, measured, candidate.change);
}

}  // namespace hive::advising
