#include "branch.hpp"

namespace hive::mixtures {
namespace {

using namespace std::chrono_literals;

const std::vector<Endpoint> all_outputs{{forker, "left"}, {forker, "right"}, {joiner, "set"}};

}  // namespace

Branch::Branch(const test::Swarm& swarm)
    : application_({.name = "branch", .home = swarm.home(), .timeout = test::stated(5000ms)}),
      outputs_(application_.collect(all_outputs))
{
    // One input asks for one event at a time and the other gets all, so one waits for the other.
    application_.connect({forker, "left"}, {joiner, "left"});
    application_.connect({forker, "right"}, {joiner, "right"}, {.transfer = Transfer::streaming});
    thread_ = std::jthread([this](const std::stop_token& ending) { run(ending); });
}

void Branch::run(const std::stop_token& ending)
{
    while (true)
        if (const auto event = outputs_->next(20ms))
            ++came_[event->sender + "." + event->output][{event->identity.epoch, event->header.at("index")}];
        else if (ending.stop_requested())
            return;
        else if (outputs_->ended())
            std::this_thread::sleep_for(5ms);
}

std::vector<Received> Branch::received(const Numbering& numbering)
{
    thread_.request_stop();
    thread_.join();
    std::vector<Received> all;
    for (const auto& output : all_outputs) {
        auto& received = all.emplace_back(Received{.drone = forker, .what = to_text(output)});
        for (const auto& [event, times] : came_[to_text(output)])
            received.times[{numbering.run_of(event.first), event.second}] += times;
    }
    return all;
}

}  // namespace hive::mixtures
