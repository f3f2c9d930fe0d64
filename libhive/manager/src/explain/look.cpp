// Queries in rounds: each answer names further drones.
#include "look.hpp"

#include <hive/event/home.hpp>
#include <hive/name.hpp>
#include <hive/platform/process.hpp>
#include <hive/program.hpp>
#include <hive/protocol/requests.hpp>
#include <hive/stall.hpp>
#include <hive/transport/address.hpp>

#include <algorithm>

namespace hive::explaining {
namespace {

constexpr std::size_t max_asked = 2000;

/// The kind in its state file; empty: none that can be started.
std::string kind_in_state(const event::Home& home, const std::string& drone)
try {
    const auto state = home.read_state(drone);
    const auto kind = state ? Fields(*state, "state").text("kind") : "";
    return !kind.empty() && program_of(kind) ? kind : "";
} catch (const Error&) {
    return "";  // a damaged file
}

/// The senders in its state file.
std::vector<std::string> senders_in_state(const event::Home& home, const std::string& drone)
try {
    std::vector<std::string> names;
    if (const auto state = is_name(drone) ? home.read_state(drone) : std::nullopt)
        for (const auto& connection : Fields(*state, "state").array("connections"))
            names.push_back(protocol::connect_from_json(connection).drone);
    return names;
} catch (const Error&) {
    return {};  // damaged, or of an older version
}

/// The names of further drones in an answer.
std::vector<std::string> next_to(const StatusAnswer& answer)
{
    std::vector<std::string> names;
    const auto* status = value_of(answer.status);
    if (!status)
        return names;
    for (const auto& input : status->inputs)
        names.push_back(parse_endpoint(input.from).drone);
    for (const auto& output : status->outputs)
        if (stalls(*status, output))
            for (const auto* edge : awaited(output))
                names.push_back(parse_endpoint(edge->receiver).drone);
    return names;
}

}  // namespace

void Absent::add(Application& application, const std::string& drone)
{
    if (!is_name(drone))
        return;
    const event::Home home(application.home());
    const auto pid = home.holder(drone);
    if (home.alive(drone) && pid > 0)
        processes[drone] = pid;
    if (home.alive(drone) && platform::process_is_suspended(pid))
        suspended[drone] = pid;
    else if (home.alive(drone) && !std::filesystem::exists(home.path(drone, ".sock")))
        starting[drone] = pid;
    if (const auto kind = kind_in_state(home, drone); !kind.empty()) {
        kinds[drone] = kind;
        remembered.insert(drone);
    } else if (const auto by_name = kind_by_name(drone)) {
        kinds[drone] = *by_name;
    }
}

void Absent::add_machines(Application& application)
{
    for (const auto& drone : application.drones())
        try {
            const auto place = application.place(drone);
            if (!place.ssh.empty())
                ssh[transport::parse_address(place.address).host] = place.ssh;
        } catch (const Error&) {
            continue;  // several of this name, or gone since
        }
}

const StatusAnswer* Look::find(const std::string& drone) const
{
    const auto exact = std::ranges::find(answers, drone, &StatusAnswer::drone);
    const auto* error = exact != answers.end() ? error_of(exact->status) : nullptr;
    if (exact != answers.end() && (!error || error->code() != Errc::invalid_argument))
        return &*exact;
    const auto same = [&](const StatusAnswer& answer) {
        const auto* status = value_of(answer.status);
        return status && status->name == drone;
    };
    const auto found = std::ranges::find_if(answers, same);
    return found != answers.end() && std::ranges::count_if(answers, same) == 1 ? &*found : nullptr;
}

Ask status_by(Application& application)
{
    return [&application](const std::vector<std::string>& drones) { return application.status(drones); };
}

Look look_from(Application& application, const std::vector<std::string>& drones, const Ask& ask)
{
    Look look;
    const event::Home home(application.home());
    std::set<std::string> asked;
    for (auto next = drones; !next.empty() && asked.size() < max_asked;) {
        std::vector<std::string> fresh;
        for (const auto& name : next)
            if (asked.insert(name).second)
                fresh.push_back(name);
        next.clear();
        for (auto& answer : ask(fresh)) {
            auto names = next_to(answer);
            if (error_of(answer.status) && !is_elsewhere(answer.place))
                names = look.saved_senders[answer.drone] = senders_in_state(home, answer.drone);
            for (auto& name : names)
                if (!look.find(name))
                    next.push_back(std::move(name));
            look.answers.push_back(std::move(answer));
        }
        std::erase_if(next, [&](const std::string& name) { return asked.contains(name); });
    }
    return look;
}

bool is_elsewhere(const Place& place) { return !place.address.empty() && place.host != Place::here; }

std::vector<const EdgeStatus*> awaited(const OutputStatus& output)
{
    std::vector<const EdgeStatus*> edges;
    for (const auto& edge : output.edges) {
        if (edge.why != output.why)
            continue;
        if (!edge.group) {
            edges.push_back(&edge);
            continue;
        }
        std::vector<const EdgeStatus*> present, lost;
        for (const auto& member : output.edges)
            if (!member.group && member.options.group == edge.options.group)
                (member.connected ? present : lost).push_back(&member);
        const auto& members = present.empty() ? lost : present;  // these have the work of the lost ones
        edges.insert(edges.end(), members.begin(), members.end());
    }
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

}  // namespace hive::explaining
