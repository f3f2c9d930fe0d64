#include "received.hpp"

namespace hive::mixtures {

Problems wrongly_received(const Received& received, const Model& model, const LastRun& run)
{
    Problems problems;
    const auto note = [&](const std::string& text) {
        problems.push_back("received: " + received.what + " of " + received.way.back() + ": " + text);
    };
    for (const auto& wrong : received.wrong)
        note(wrong);
    const auto name = [](std::int64_t epoch, std::int64_t number) {
        return "event " + std::to_string(number) + " (epoch " + std::to_string(epoch) + ")";
    };
    for (const auto& [event, times] : received.times)
        if (times > 1)
            note(name(event.first, event.second) + " came " + std::to_string(times) + " times");
    for (std::int64_t number = 1; run.lossless && number <= run.produced; ++number)
        if (!received.times.contains({run.epoch, number}) && model.owes(received.way, run.epoch, number))
            note(name(run.epoch, number) + " is missing");
    return problems;
}

}  // namespace hive::mixtures
