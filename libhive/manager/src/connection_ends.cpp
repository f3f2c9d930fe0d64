// Joins the senders' edges with the receivers' inputs: by name and by registration.
#include <hive/connection_ends.hpp>

#include <algorithm>
#include <tuple>

namespace hive {
namespace {

/// Two registrations of one name are two connections, unless the receiver is reconnecting.
bool same_connection(const ConnectionEnds& ends, const std::string& to, const InputStatus& input)
{
    return ends.at_sender && !ends.at_receiver && ends.from == input.from && ends.to == to
           && (ends.at_sender->registration == input.registration || !input.connected);
}

/// The host of a drone in the directory, whether it answered or not; empty for others, such as applications.
/// @param end  "camera.image", or the name alone
std::string host_of(const std::string& end, const std::vector<StatusAnswer>& statuses)
{
    const auto knows = [&](const std::string& name) { return std::ranges::find(statuses, name, &StatusAnswer::drone); };
    auto found = knows(end);
    if (found == statuses.end())
        found = knows(parse_endpoint(end).drone);
    return found == statuses.end() ? "" : found->place.host;
}

/// The whole group first, then its members.
auto order(const ConnectionEnds& ends)
{
    return std::tuple(ends.from, ends.options().group, !ends.is_group(), ends.to);
}

}  // namespace

std::vector<ConnectionEnds> connection_ends(const std::vector<StatusAnswer>& statuses)
{
    std::vector<ConnectionEnds> all;
    for (const auto& answer : statuses)
        if (const auto* status = value_of(answer.status))
            for (const auto& output : status->outputs)
                for (const auto& edge : output.edges)
                    all.push_back({.from = answer.drone + "." + output.name, .to = edge.receiver, .at_sender = edge});
    for (const auto& answer : statuses)
        if (const auto* status = value_of(answer.status))
            for (const auto& input : status->inputs) {
                const std::string to = answer.drone + "." + input.input;
                const auto same = std::ranges::find_if(
                    all, [&](const ConnectionEnds& ends) { return same_connection(ends, to, input); });
                if (same != all.end())
                    same->at_receiver = input;
                else
                    all.push_back({.from = input.from, .to = to, .at_receiver = input});
            }
    for (auto& ends : all) {
        ends.from_host = host_of(ends.from, statuses);
        ends.to_host = ends.is_group() ? "" : host_of(ends.to, statuses);
    }
    std::ranges::stable_sort(all, {}, order);
    return all;
}

}  // namespace hive
