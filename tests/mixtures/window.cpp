// Windows at both ends of an edge.
#include "window.hpp"
#include "picture.hpp"

#include <algorithm>

namespace hive::mixtures {
namespace {

constexpr std::int64_t max_streamed = 64;  ///< lossless events of a stream beyond `worked`

bool is_synchronized(const ConnectionOptions& options) { return options.transfer == Transfer::synchronized; }
bool is_application(const std::string& receiver) { return receiver.find('.') == std::string::npos; }

}  // namespace

/// What is in hand at the first look at a registration may have been taken over from one with a larger window; later it
/// only becomes less.
bool Window::fits(const std::string& key, std::int64_t registration, std::int64_t in_hand, std::int64_t window)
{
    Row& row = rows_[key];
    const bool same = row.registration == registration;
    row = {registration, same ? std::min(row.taken_over, in_hand) : in_hand,
           row.again || (!same && row.registration != 0)};
    return in_hand <= std::max(window, row.taken_over);
}

void Window::look(const std::string& drone, const InputStatus& input, Problems& problems)
{
    const bool streaming = !is_synchronized(input.options);
    if ((streaming && !lossless_) || drone.starts_with(joiner))
        return;  // the queues alone bound live events of a stream, and what waits for its partners
    const auto window = streaming ? max_streamed : input.options.window;
    if (!fits(drone + "." + input.input + " <- " + input.from, input.registration, input.queued + input.in_hand,
              window))
        problems.push_back("window: " + input.from + " -> " + drone + " has more than " + std::to_string(window)
                           + " in hand: " + to_text(input));
}

/// A sender is not told what was worked on, only what is done. The two are the same where nobody waits for results, and
/// where the receiver finishes in order: a second answer is refused before what is in hand, as is work when a drone
/// halts. A peer that lies tells what it likes.
bool Window::tells_all(const std::string& sender, const EdgeStatus& edge) const
{
    if (edge.group || !edge.connected || !is_synchronized(edge.options) || !edge.options.group.empty()
        || edge.receiver.starts_with(liar))
        return false;
    const bool no_results = !lossless_ || edge.options.delivery == Delivery::notification;
    return is_application(edge.receiver) || (sender == source && no_results);
}

void Window::look(const std::string& sender, const std::string& output, const EdgeStatus& edge, Problems& problems)
{
    const auto key = output + " -> " + edge.receiver;
    if (!tells_all(sender, edge)) {
        if (edge.connected && edge.options.group.empty())
            rows_[key] = {edge.registration, 0, true};
        return;
    }
    const auto in_flight = edge.events.in_flight() - edge.waiting;
    const bool fit = fits(key, edge.registration, in_flight, edge.options.window);
    // A receiver that resumes asks for a window at once, and acknowledges what it did meanwhile in its first request.
    if (const auto& row = rows_.at(key); !fit && !(row.again && in_flight <= edge.options.window + row.taken_over))
        problems.push_back("window: " + output + " -> " + edge.receiver + " has sent more than "
                           + std::to_string(edge.options.window) + ": " + to_text(edge));
}

Problems Window::look(const Statuses& statuses)
{
    Problems problems;
    for (const auto& [name, status] : statuses) {
        const auto life = name + " (epoch " + std::to_string(status.epoch) + ")";
        for (const auto& input : status.inputs)
            look(life, input, problems);
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges)
                look(name, life + "." + output.name, edge, problems);
    }
    return problems;
}

}  // namespace hive::mixtures
