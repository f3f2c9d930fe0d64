// Causes in a connection, rather than in one of its drones.
#include "search.hpp"

#include <hive/duration_text.hpp>
#include <hive/stall.hpp>

#include <algorithm>

namespace hive {

std::optional<int> window_that_helps(const EdgeStatus& edge, const InputStatus& input)
{
    constexpr std::int64_t per_second = 60, max_window = 64;
    const auto needed = std::min(max_window, input.round_trip_us * per_second / 1'000'000 + 1);
    const bool waits = edge.options.transfer == Transfer::synchronized && edge.events.of(Fate::skipped) > 0;
    return waits && edge.options.window < needed ? std::optional(static_cast<int>(needed)) : std::nullopt;
}

namespace explaining {
namespace {

using What = Cause::What;

/// The row of a registration at its sender; null: it has none.
const EdgeStatus* edge_of(const StatusAnswer* sender, const std::string& end, const InputStatus& input)
{
    const auto* status = sender ? value_of(sender->status) : nullptr;
    if (!status)
        return nullptr;
    for (const auto& output : status->outputs)
        for (const auto& edge : output.edges)
            if (input.from.ends_with("." + output.name) && edge.receiver == end
                && edge.registration == input.registration)
                return &edge;
    return nullptr;
}

}  // namespace

Search::Link Search::link_at(const StatusAnswer& receiver, const InputStatus& input) const
{
    Link link{.receiver = &receiver,
              .sender = look_.find(parse_endpoint(input.from).drone),
              .from = input.from,
              .to = std::get<Status>(receiver.status).name + "." + input.input};
    link.edge = edge_of(link.sender, link.to, input);
    link.earlier = earlier_ ? edge_of(earlier_->find(parse_endpoint(input.from).drone), link.to, input) : link.edge;
    link.first_look = earlier_ == nullptr;
    return link;
}

void Search::slower(What what, const Link& link, const std::string& text, const std::string& evidence,
                    const std::string& command)
{
    const auto connection = link.from + " -> " + link.to;
    auto& cause = add(what, link.receiver->drone, connection + ": " + text, evidence, command);
    cause.connection = connection;
    cause.blocks = false;
}

/// For an input whose sender is running.
void Search::unconnected(const StatusAnswer& answer, const InputStatus& input)
{
    const auto end = answer.drone + "." + input.input;
    const bool refused = input.why == Reason::refused;
    if (!refused && input.why != Reason::dialing)
        return;
    const auto connect = is_plain(input.from) ? "hivectl connect " + input.from + " " + end : "";
    const auto advised = refused ? command_in(input.error) : "";
    const auto text =
        refused ? input.from + " refuses " + end + ": " + input.error
                : end + " is not connected to " + input.from + (input.error.empty() ? "" : ": " + input.error);
    add(refused ? What::refused : What::dialing, answer.drone, text, "", advised.empty() ? connect : advised)
        .connection = input.from + " -> " + end;
}

/// For a connection that skips events because too few are requested ahead.
void Search::narrow(const StatusAnswer& answer, const InputStatus& input)
{
    const auto link = link_at(answer, input);
    const auto window = link ? window_that_helps(*link.edge, input) : std::nullopt;
    if (!window || !link.grew([](const EdgeStatus& edge) { return edge.events.of(Fate::skipped); }))
        return;
    slower(What::small_window, link,
           "a window of " + std::to_string(link.edge->options.window) + " lets at most "
               + std::to_string(link.edge->options.window * 1'000'000 / input.round_trip_us)
               + " events per second through",
           "round trip " + duration_text(input.round_trip_us) + ", "
               + std::to_string(link.edge->events.of(Fate::skipped)) + " events skipped",
           "hivectl connect " + link.from + " " + link.to + " --window " + std::to_string(*window));
}

/// For a connection whose sender could emit more without encoding for it.
void Search::encoded(const StatusAnswer& answer, const InputStatus& input)
{
    constexpr double all_the_time = 0.9;
    const auto link = link_at(answer, input);
    const auto* now = link ? value_of(link.sender->status) : nullptr;
    if (!now || link.edge->encoding.empty() || now->encoding_us == 0
        || !link.grew([](const EdgeStatus& edge) { return edge.events.of(Fate::skipped); }))
        return;
    if (const auto* earlier = before(*link.sender))
        if (static_cast<double>(now->encoding_us - earlier->encoding_us)
            < all_the_time * static_cast<double>(now->uptime_us - earlier->uptime_us))
            return;
    const bool near = input.round_trip_us == 0, is_jpeg = link.edge->encoding.starts_with("jpeg");
    slower(What::encoder, link, link.sender->drone + " encodes all the time, as " + link.edge->encoding,
           std::to_string(link.edge->events.of(Fate::skipped)) + " events skipped",
           near      ? "hivectl connect " + link.from + " " + link.to + " --encoding raw"
           : is_jpeg ? "hivectl top"
                     : "hivectl connect " + link.from + " " + link.to + " --encoding jpeg");
}

/// For a stream whose queue overflows: at the sender if the connection is slow, at the receiver if its code is.
void Search::dropping(const StatusAnswer& answer, const InputStatus& input)
{
    const auto link = link_at(answer, input);
    if (!link)
        return;
    const auto dropped = [](const EdgeStatus& edge) { return edge.events.of(Fate::dropped); };
    if (dropped(*link.edge) > 0 && link.grew(dropped))
        slower(What::slow_connection, link, "the connection takes events more slowly than they are emitted",
               std::to_string(dropped(*link.edge)) + " events dropped before they were sent", "");
    const auto& status = std::get<Status>(answer.status);
    std::int64_t was = 0;
    if (const auto* earlier = before(answer))
        for (const auto& row : earlier->inputs)
            was += row.from == input.from && row.registration == input.registration ? row.dropped : 0;
    if (input.dropped > was)
        slower(What::slow, link, answer.drone + " takes events more slowly than they come",
               std::to_string(input.dropped) + " events dropped, " + duration_text(work_us(status)) + " for each event"
                   + p99_text(status),
               "hivectl advise " + answer.drone);
}

/// For a connection on one machine whose large bodies go through the socket.
void Search::copied(const StatusAnswer& answer, const InputStatus& input)
{
    const auto link = link_at(answer, input);
    if (!link || link.edge->fallback == 0 || !link.grew(&EdgeStatus::fallback))
        return;
    if (link.edge->shared > 0)
        return;  // sharing works: the receiver holds as many bodies as it may, and gets the others copied
    slower(What::copied, link, "shared memory does not take the bodies, which are copied",
           std::to_string(link.edge->fallback) + " copied, " + std::to_string(link.edge->shared)
               + " through shared memory",
           "hivectl replace " + link.sender->drone);
}

}  // namespace explaining
}  // namespace hive
