// Merges the rows of both ends, with the keys of --json.
#include "words/connections.hpp"

#include <hive/connection_ends.hpp>
#include <hive/explain.hpp>

#include <algorithm>
#include <array>

namespace hivectl {
namespace {

using hive::EdgeStatus;
using hive::Fate;
using hive::InputStatus;

const char* kind_of(const hive::ConnectionEnds& ends)
{
    if (ends.is_group())
        return "group";
    return ends.options().group.empty() ? "receiver" : "member";
}

const char* state_of(const hive::ConnectionEnds& ends)
{
    if (ends.at_sender && !ends.at_sender->connected)
        return ends.at_sender->why == hive::Reason::place_kept ? "place_kept" : "gone";
    return ends.at_receiver && !ends.at_receiver->connected ? "waiting" : "connected";
}

/// The transport of bodies: shared memory or socket; null before the first body.
hive::Json way_of(const std::optional<EdgeStatus>& edge)
{
    if (!edge)
        return nullptr;
    if (edge->shared == 0)
        return edge->events.of(Fate::acknowledged) > 0 ? hive::Json("socket") : hive::Json();
    return edge->fallback == 0 ? "memory" : "memory, " + std::to_string(edge->fallback) + " by socket";
}

/// Events offered to the edge or its receiver that the receiver's code will never process.
std::int64_t missing(const hive::ConnectionEnds& ends)
{
    std::int64_t events = 0;
    if (const auto& edge = ends.at_sender)
        events += edge->events.of(Fate::dropped) + edge->events.of(Fate::abandoned) + edge->events.lost();
    if (const auto& input = ends.at_receiver)
        events += input->dropped + input->abandoned + input->unmatched
                  + (ends.options().group.empty() ? input->discarded : 0);  // a member returns discarded events
    return events;
}

hive::Json text_or_null(std::string_view text) { return text.empty() ? hive::Json() : hive::Json(text); }

hive::Json why_of(const hive::ConnectionEnds& ends)
{
    const auto at_sender = ends.at_sender ? ends.at_sender->why : hive::Reason::none;
    return text_or_null(
        hive::token(at_sender == hive::Reason::none && ends.at_receiver ? ends.at_receiver->why : at_sender));
}

void add_names(Row& row, const hive::ConnectionEnds& ends)
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

void add_sender_counts(Row& row, const std::optional<EdgeStatus>& edge)
{
    const auto add = [&](std::string_view key, std::int64_t count) {
        row.add(std::string(key), edge ? hive::Json(count) : hive::Json());
    };
    const auto known = edge.value_or(EdgeStatus{});
    add("came", known.events.total());
    for (std::size_t fate = 0; fate < hive::fates; ++fate)
        add(token(static_cast<Fate>(fate)), known.events.of(static_cast<Fate>(fate)));
    add("lost", known.events.lost());
    add("in_flight", known.events.in_flight());
    add("waiting", known.waiting);
    add("shared", known.shared);
    add("fallback", known.fallback);
}

void add_receiver_counts(Row& row, const std::optional<InputStatus>& input)
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
        row.add(key, input ? hive::Json((*input).*count) : hive::Json());
    row.add("error", input ? text_or_null(input->error) : hive::Json());
    const bool measured = input && input->round_trip_us > 0;
    row.add("round_trip_us", measured ? hive::Json(input->round_trip_us) : hive::Json());
    row.add("clock_offset_us", measured ? hive::Json(input->clock_offset_us) : hive::Json());
}

/// Null if the current one is wide enough or unknown.
hive::Json window_advised(const hive::ConnectionEnds& ends)
{
    const auto window =
        ends.at_sender && ends.at_receiver ? hive::window_that_helps(*ends.at_sender, *ends.at_receiver) : std::nullopt;
    return window ? hive::Json(*window) : hive::Json();
}

Row row_of(const hive::ConnectionEnds& ends)
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
    for (const auto& ends : hive::connection_ends(statuses))
        rows.push_back(row_of(ends));
    return rows;
}

}  // namespace hivectl
