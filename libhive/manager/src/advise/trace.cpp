// Walks upstream from a drone to the source; of several inputs, takes the one with the oldest events.
#include "trace.hpp"

#include "../directory.hpp"

#include <algorithm>
#include <set>

namespace hive::advising {
namespace {

using explaining::Look;

const StatusAnswer* answering(const Look& look, const std::string& drone)
{
    const auto* answer = look.find(drone);
    return answer && value_of(answer->status) ? answer : nullptr;
}

/// Does it receive from that drone, directly or indirectly?
bool carries_events(const Look& look, const InputStatus& input)
{
    return input.connected && input.options.delivery == Delivery::data
           && answering(look, parse_endpoint(input.from).drone);
}

bool comes_from(const Look& look, const std::string& drone, const std::string& source, std::set<std::string>& seen)
{
    const auto* answer = answering(look, drone);
    if (!answer || !seen.insert(answer->drone).second)
        return false;
    const auto carries_from = [&](const InputStatus& input) {
        return carries_events(look, input) && comes_from(look, parse_endpoint(input.from).drone, source, seen);
    };
    return answer->drone == source || std::ranges::any_of(std::get<Status>(answer->status).inputs, carries_from);
}

/// @param passed  drones already on the path: their events are feedback
const InputStatus* input_on_way(const Look& look, const Status& status, const std::string& source,
                                const std::set<std::string>& passed = {})
{
    const InputStatus* found = nullptr;
    for (const auto& input : status.inputs) {
        if (!carries_events(look, input) || passed.contains(answering(look, parse_endpoint(input.from).drone)->drone))
            continue;
        auto seen = passed;
        if ((source.empty() || comes_from(look, parse_endpoint(input.from).drone, source, seen))
            && (!found || input.last_age_us > found->last_age_us))
            found = &input;
    }
    return found;
}

std::vector<std::string> members_of(const Look& look, const StatusAnswer& one, const Step& step)
{
    if (step.group.empty())
        return {one.drone};
    std::vector<std::string> members;
    for (const auto& answer : look.answers)
        if (const auto* status = value_of(answer.status);
            status && std::ranges::any_of(status->inputs, [&](const InputStatus& input) {
                return input.connected && input.from == step.from && input.options.group == step.group;
            }))
            members.push_back(answer.drone);
    return members;
}

/// Empty: no source was found.
std::vector<Step> way_to(const Look& look, const std::string& target, const std::string& source)
{
    std::vector<Step> way;
    std::set<std::string> seen;
    for (const auto* answer = answering(look, target); answer && seen.insert(answer->drone).second;) {
        const auto& status = std::get<Status>(answer->status);
        const auto* input = answer->drone == source ? nullptr : input_on_way(look, status, source, seen);
        Step step{.members = {answer->drone}};
        if (input) {
            step = {.from = input->from, .input = input->input, .group = input->options.group};
            step.members = members_of(look, *answer, step);
        }
        if (!way.empty())
            way.front().senders = step.members;
        way.insert(way.begin(), step);
        if (!input)
            return source.empty() || answer->drone == source ? way : std::vector<Step>();
        answer = answering(look, parse_endpoint(input->from).drone);
    }
    return {};
}

/// Those that receive, and that no other drone receives from.
std::vector<std::string> last_drones(const Look& look)
{
    std::set<std::string> senders;
    for (const auto& answer : look.answers)
        if (const auto* status = value_of(answer.status))
            for (const auto& input : status->inputs)
                if (const auto* sender = input.connected ? answering(look, parse_endpoint(input.from).drone) : nullptr)
                    senders.insert(sender->drone);
    std::vector<std::string> last;
    for (const auto& answer : look.answers)
        if (const auto* status = value_of(answer.status);
            status && !senders.contains(answer.drone) && input_on_way(look, *status, ""))
            last.push_back(answer.drone);
    return last;
}

void require_running(const Look& look, const std::string& drone)
{
    const auto* answer = look.find(drone);
    if (!answer)
        throw Error(Errc::not_found, drone + " is not running", "see which run: hivectl ps");
    value_or_throw(answer->status);
}

}  // namespace

std::vector<const InputStatus*> inputs_of(const Status& member, const Step& step)
{
    std::vector<const InputStatus*> rows;
    for (const auto& input : member.inputs)
        if (input.connected && input.input == step.input
            && parse_endpoint(input.from).port == parse_endpoint(step.from).port
            && std::ranges::any_of(
                step.senders, [&](const auto& sender) { return drone_of(sender) == parse_endpoint(input.from).drone; }))
            rows.push_back(&input);
    return rows;
}

const EdgeStatus* edge_of(const Status& sender, const Step& step, const std::string& member)
{
    const auto receiver = step.group.empty() ? drone_of(member) + "." + step.input : "group " + step.group;
    for (const auto& output : sender.outputs)
        if (output.name == parse_endpoint(step.from).port)
            for (const auto& edge : output.edges)
                if (edge.receiver == receiver && edge.group == !step.group.empty())
                    return &edge;
    return nullptr;
}

std::vector<std::vector<Step>> trace(const Look& look, const std::vector<std::string>& drones)
{
    for (const auto& drone : drones)
        require_running(look, drone);
    const std::string source = drones.size() == 2 ? look.find(drones.front())->drone : "";
    std::vector<std::vector<Step>> ways;
    std::set<std::string> reached;
    for (const auto& target : drones.empty() ? last_drones(look) : std::vector{drones.back()}) {
        if (reached.contains(target))
            continue;
        auto way = way_to(look, target, source);
        if (way.size() < 2)
            continue;
        reached.insert(way.back().members.begin(), way.back().members.end());
        ways.push_back(std::move(way));
    }
    if (ways.empty() && !drones.empty())
        throw Error(Errc::not_found,
                    source.empty() ? drones.back() + " receives from no drone that answers"
                                   : "no events go from " + source + " to " + drones.back(),
                    "hivectl explain " + drones.back());
    return ways;
}

}  // namespace hive::advising
