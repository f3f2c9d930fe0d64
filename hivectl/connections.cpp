// Joining the senders' edges with the receivers' connections: by name and by registration.
#include "connections.hpp"

#include <hive/explain.hpp>

#include <algorithm>
#include <array>
#include <tuple>

namespace hivectl {
namespace {

using hive::EdgeStatus;
using hive::Fate;
using hive::InputStatus;

/// What each end says of one edge; null when it says nothing.
struct BothEnds {
    std::string from, to;
    const EdgeStatus* at_sender = nullptr;
    const InputStatus* at_receiver = nullptr;
    std::string from_host{}, to_host{};  ///< empty: not known

    [[nodiscard]] const hive::ConnectionOptions& options() const
    {
        return at_sender ? at_sender->options : at_receiver->options;
    }
    [[nodiscard]] bool is_group() const { return at_sender && at_sender->group; }
    /// The whole group first, then its members.
    [[nodiscard]] auto order() const { return std::tuple(from, options().group, !is_group(), to); }
};

/// Two registrations of one name are two edges, unless the receiver is only trying to come back.
bool same_edge(const BothEnds& ends, const std::string& to, const InputStatus& input)
{
    return ends.at_sender && !ends.at_receiver && ends.from == input.from && ends.to == to
           && (ends.at_sender->registration == input.registration || !input.connected);
}

/// The host of a drone that the directory knows, whether it answered or not; empty for others, such as applications.
/// @param end  "camera.image", or the name alone
std::string host_of(const std::string& end, const std::vector<hive::StatusAnswer>& statuses)
{
    const auto knows = [&](const std::string& name) {
        return std::ranges::find(statuses, name, &hive::StatusAnswer::drone);
    };
    auto found = knows(end);
    if (found == statuses.end())
        found = knows(end.substr(0, end.rfind('.')));
    return found == statuses.end() ? "" : found->place.host;
}

std::vector<BothEnds> joined(const std::vector<hive::StatusAnswer>& statuses)
{
    std::vector<BothEnds> edges;
    for (const auto& answer : statuses)
        for (const auto& output : answer.status.outputs)
            for (const auto& edge : output.edges)
                edges.push_back({answer.drone + "." + output.name, edge.receiver, &edge, nullptr});
    for (const auto& answer : statuses)
        for (const auto& input : answer.status.inputs) {
            const std::string to = answer.drone + "." + input.input;
            const auto same =
                std::ranges::find_if(edges, [&](const BothEnds& ends) { return same_edge(ends, to, input); });
            if (same != edges.end())
                same->at_receiver = &input;
            else
                edges.push_back({input.from, to, nullptr, &input});
        }
    for (auto& ends : edges) {
        ends.from_host = host_of(ends.from, statuses);
        ends.to_host = ends.is_group() ? "" : host_of(ends.to, statuses);
    }
    std::ranges::stable_sort(edges, {}, &BothEnds::order);
    return edges;
}

const char* kind_of(const BothEnds& ends)
{
    if (ends.is_group())
        return "group";
    return ends.options().group.empty() ? "receiver" : "member";
}

const char* state_of(const BothEnds& ends)
{
    if (ends.at_sender && !ends.at_sender->connected)
        return ends.at_sender->why == hive::Reason::place_kept ? "place_kept" : "gone";
    return ends.at_receiver && !ends.at_receiver->connected ? "waiting" : "connected";
}

/// How the bodies travel: through shared memory, or through the socket; null as long as none did.
hive::Json way_of(const EdgeStatus* edge)
{
    if (!edge)
        return nullptr;
    if (edge->shared == 0)
        return edge->events.of(Fate::acknowledged) > 0 ? hive::Json("socket") : hive::Json();
    return edge->fallback == 0 ? "memory" : "memory, " + std::to_string(edge->fallback) + " by socket";
}

/// Of what came to the edge, or to its receiver, what the receiver's code has not dealt with and never will.
std::int64_t missing(const BothEnds& ends)
{
    std::int64_t events = 0;
    if (const auto* edge = ends.at_sender)
        events += edge->events.of(Fate::dropped) + edge->events.of(Fate::abandoned) + edge->events.lost();
    if (const auto* input = ends.at_receiver)
        events += input->dropped + input->abandoned + input->unmatched
                  + (ends.options().group.empty() ? input->discarded : 0);  // a member hands back what it discards
    return events;
}

hive::Json text_or_null(std::string_view text) { return text.empty() ? hive::Json() : hive::Json(text); }

hive::Json why_of(const BothEnds& ends)
{
    const auto at_sender = ends.at_sender ? ends.at_sender->why : hive::Reason::none;
    return text_or_null(
        hive::token(at_sender == hive::Reason::none && ends.at_receiver ? ends.at_receiver->why : at_sender));
}

void add_names(Row& row, const BothEnds& ends)
{
    const auto& options = ends.options();
    row.add("from_host", text_or_null(ends.from_host)).add("to_host", text_or_null(ends.to_host));
    row.add("kind", kind_of(ends)).add("transfer", token(options.transfer)).add("delivery", token(options.delivery));
    row.add("window", options.window).add("group", text_or_null(options.group));
    row.add("encoding", text_or_null(ends.at_sender ? ends.at_sender->encoding : options.encoding));
    row.add("way", way_of(ends.at_sender));
    row.add("state", ends.is_group() ? hive::Json() : hive::Json(state_of(ends)));
    row.add("known_by", !ends.at_receiver ? "sender" : !ends.at_sender ? "receiver" : "both");
}

void add_sender_counts(Row& row, const EdgeStatus* edge)
{
    const auto add = [&](std::string_view key, std::int64_t count) {
        row.add(std::string(key), edge ? hive::Json(count) : hive::Json());
    };
    const auto nothing = EdgeStatus{};
    const auto& known = edge ? *edge : nothing;
    add("came", known.events.total());
    for (std::size_t fate = 0; fate < hive::fates; ++fate)
        add(token(static_cast<Fate>(fate)), known.events.of(static_cast<Fate>(fate)));
    add("lost", known.events.lost());
    add("in_flight", known.events.in_flight());
    add("waiting", known.waiting);
    add("shared", known.shared);
    add("fallback", known.fallback);
}

void add_receiver_counts(Row& row, const InputStatus* input)
{
    using Count = std::pair<const char*, std::int64_t InputStatus::*>;
    constexpr std::array counts{Count{"received", &InputStatus::received},
                                Count{"processed", &InputStatus::processed},
                                Count{"dropped_by_receiver", &InputStatus::dropped},
                                Count{"abandoned_by_receiver", &InputStatus::abandoned},
                                Count{"duplicates", &InputStatus::duplicates},
                                Count{"discarded", &InputStatus::discarded},
                                Count{"unmatched", &InputStatus::unmatched},
                                Count{"queued", &InputStatus::queued},
                                Count{"in_hand", &InputStatus::in_hand},
                                Count{"age_us", &InputStatus::last_age_us}};
    for (const auto& [key, count] : counts)
        row.add(key, input ? hive::Json(input->*count) : hive::Json());
    row.add("error", input ? text_or_null(input->error) : hive::Json());
    const bool measured = input && input->round_trip_us > 0;
    row.add("round_trip_us", measured ? hive::Json(input->round_trip_us) : hive::Json());
    row.add("clock_offset_us", measured ? hive::Json(input->clock_offset_us) : hive::Json());
}

/// Null when the present one is wide enough, or when nothing is known of it.
hive::Json window_advised(const BothEnds& ends)
{
    const auto window =
        ends.at_sender && ends.at_receiver ? hive::window_that_helps(*ends.at_sender, *ends.at_receiver) : std::nullopt;
    return window ? hive::Json(*window) : hive::Json();
}

Row row_of(const BothEnds& ends)
{
    Row row{{"from", ends.from}, {"to", ends.to}};
    add_names(row, ends);
    add_sender_counts(row, ends.at_sender);
    add_receiver_counts(row, ends.at_receiver);
    return row.add("missing", missing(ends)).add("why", why_of(ends)).add("window_advised", window_advised(ends));
}

}  // namespace

std::vector<Row> connection_rows(const std::vector<hive::StatusAnswer>& statuses)
{
    std::vector<Row> rows;
    for (const auto& ends : joined(statuses))
        rows.push_back(row_of(ends));
    return rows;
}

}  // namespace hivectl
