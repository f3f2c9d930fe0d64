// What lies with a connection, rather than with one of the drones.
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
    if (!sender || sender->error)
        return nullptr;
    for (const auto& output : sender->status.outputs)
        for (const auto& edge : output.edges)
            if (input.from.ends_with("." + output.name) && edge.receiver == end
                && edge.registration == input.registration)
                return &edge;
    return nullptr;
}

}  // namespace

/// Of an input whose sender runs.
void Search::unconnected(const StatusAnswer& answer, const InputStatus& input)
{
    const auto end = answer.drone + "." + input.input, connection = input.from + " -> " + end;
    if (input.why == Reason::refused)
        add(What::refused, answer.drone, input.from + " refuses " + end + ": " + input.error, "",
            "hivectl connect " + input.from + " " + end)
            .connection = connection;
    else if (input.why == Reason::dialing)
        add(What::dialing, answer.drone,
            end + " is not connected to " + input.from + (input.error.empty() ? "" : ": " + input.error), "",
            "hivectl logs " + answer.drone)
            .connection = connection;
}

/// Of a connection at which events are skipped because few are requested ahead.
void Search::narrow(const StatusAnswer& answer, const InputStatus& input)
{
    const auto end = answer.status.name + "." + input.input;
    const auto* edge = edge_of(look_.find(owner_of(input.from)), end, input);
    const auto* earlier = earlier_ ? edge_of(earlier_->find(owner_of(input.from)), end, input) : nullptr;
    const auto window = edge ? window_that_helps(*edge, input) : std::nullopt;
    if (!window || (earlier_ && (!earlier || edge->events.of(Fate::skipped) == earlier->events.of(Fate::skipped))))
        return;
    auto& cause =
        add(What::small_window, answer.drone,
            input.from + " -> " + end + ": a window of " + std::to_string(edge->options.window) + " lets at most "
                + std::to_string(edge->options.window * 1'000'000 / input.round_trip_us) + " events per second through",
            "round trip " + duration_text(input.round_trip_us) + ", " + std::to_string(edge->events.of(Fate::skipped))
                + " events skipped",
            "hivectl connect " + input.from + " " + end + " --window " + std::to_string(*window));
    cause.connection = input.from + " -> " + end;
    cause.blocks = false;
}

}  // namespace explaining
}  // namespace hive
