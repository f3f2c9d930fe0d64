#include "branch.hpp"

namespace hive::mixtures {
namespace {

const std::vector<Endpoint> all_outputs{{forker, "left"}, {forker, "right"}, {joiner, "set"}};

}  // namespace

Branch::Branch(const Application::Options& options) : application_(options), outputs_(application_.collect(all_outputs))
{
    // One input asks for one event at a time and the other gets all, so one waits for the other.
    application_.connect({forker, "left"}, {joiner, "left"});
    application_.connect({forker, "right"}, {joiner, "right"}, {.transfer = Transfer::streaming});
}

bool Branch::take(std::chrono::milliseconds timeout)
{
    const auto event = outputs_->next(timeout);
    if (event)
        came_[event->sender + "." + event->output].emplace_back(event->identity, event->header.at("index"));
    return event.has_value();
}

std::vector<Received> Branch::received(const Place& place) const
{
    std::vector<Received> all;
    for (const auto& output : all_outputs) {
        const auto way = output.drone == forker ? std::vector{forker} : std::vector{forker, joiner};
        auto& received = all.emplace_back(Received{.way = way, .what = to_text(output)});
        if (const auto came = came_.find(to_text(output)); came != came_.end())
            for (const auto& [identity, index] : came->second)
                ++received.times[place(identity, index)];
    }
    return all;
}

}  // namespace hive::mixtures
