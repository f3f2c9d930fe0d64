// One sentence per reason, and the affected receivers or senders.
#include <hive/stall.hpp>

#include <algorithm>

namespace hive {
namespace {

constexpr std::int64_t a_second = 1'000'000;
constexpr std::size_t most_named = 3;

void append(std::string& text, const std::string& part)
{
    if (!part.empty())
        text += (text.empty() ? "" : "; ") + part;
}

/// "s1.image, s2.image and 4 more": the edges that are stalled for the reason of their output.
std::string receivers(const OutputStatus& output)
{
    std::string text;
    std::size_t count = 0;
    for (const auto& edge : output.edges)
        if (edge.why == output.why && ++count <= most_named)
            text += (text.empty() ? "" : ", ") + edge.receiver;
    if (count > most_named)
        text += " and " + std::to_string(count - most_named) + " more";
    return text;
}

std::string sentence_about(const OutputStatus& output)
{
    const auto names = receivers(output);
    if (output.why == Reason::not_asked && !names.empty())
        return output.name + ": waits for " + names + " to ask";
    return output.name + ": " + std::string(sentence(output.why)) + (names.empty() ? "" : " (" + names + ")");
}

std::string sentence_about(const InputStatus& input)
{
    const bool told = input.why == Reason::refused && !input.error.empty();
    return input.input + " from " + input.from + ": " + std::string(sentence(input.why))
           + (told ? ": " + input.error : "");
}

/// By the drone's clock, which started at its epoch.
bool quiet(const Status& status, const OutputStatus& output)
{
    return status.epoch + status.uptime_us - std::max(status.epoch, output.last_emitted_us) >= a_second;
}

/// Receivers of exceptions are optional, and a drone that processes inputs may have outputs that no receiver needs.
bool is_optional(const Status& status, const OutputStatus& output)
{
    const auto left_alone = [](const OutputStatus& other) {
        return other.name == "exceptions" || other.why == Reason::no_receiver || other.why == Reason::watched;
    };
    return output.name == "exceptions"
           || (left_alone(output) && (!status.inputs.empty() || !std::ranges::all_of(status.outputs, left_alone)));
}

std::string of_drone(const Status& status)
{
    // Its state already says that it has halted, and its condition which source has ended, or what it waits for.
    const bool in_condition =
        status.why == Reason::source_ended || status.why == Reason::no_receiver || status.why == Reason::watched;
    const bool told = status.why == Reason::halted || (in_condition && !status.condition.empty());
    return told ? std::string() : std::string(sentence(status.why));
}

}  // namespace

std::string_view sentence(Reason reason) noexcept
{
    switch (reason) {
    case Reason::none: break;
    case Reason::no_receiver: return "no receivers";
    case Reason::not_asked: return "a receiver has not requested more";
    case Reason::lane_full: return "the connection's send queue is full";
    case Reason::held: return "lossless events are held until there is a receiver";
    case Reason::group_awaited: return "a group lost its last member and has work pending";
    case Reason::not_acknowledged: return "the receiver does not acknowledge the events that it has processed";
    case Reason::place_kept: return "it waits for a receiver that was cut off, or has not come yet";
    case Reason::lease_running: return "the last attempt at an event is still in progress";
    case Reason::halted: return "the drone has halted";
    case Reason::backlog: return "the drone waits for receivers to request its lossless events";
    case Reason::dialing: return "the sender is not connected";
    case Reason::refused: return "the sender refused the connection";
    case Reason::no_input: return "nothing is connected to its inputs";
    case Reason::source_ended: return "the source has ended";
    case Reason::set_prepared: return "an application prepared a set and has not committed or aborted it yet";
    case Reason::watched: return "only watchers receive it, and on demand it waits for a receiver of bodies";
    }
    return {};
}

bool stalls(const Status& status, const OutputStatus& output)
{
    return output.why != Reason::none && output.why != Reason::source_ended && quiet(status, output)
           && !is_optional(status, output);
}

std::string stall_text(const Status& status)
{
    std::string text = of_drone(status);
    for (const auto& output : status.outputs)
        if (stalls(status, output))
            append(text, sentence_about(output));
    for (const auto& input : status.inputs)
        if (input.why != Reason::none && input.why != status.why)
            append(text, sentence_about(input));
    return text;
}

}  // namespace hive
