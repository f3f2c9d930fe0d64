#include "words/activity.hpp"

#include <algorithm>

namespace hivectl {
namespace {

/// By the drone's own clock, so that ours does not matter.
bool is_sending(const hive::Status& status)
{
    constexpr std::int64_t second_us = 1'000'000;
    const auto now_us = status.epoch + status.uptime_us;
    return status.state == hive::State::idle && status.inputs.empty()
           && std::ranges::any_of(status.outputs, [&](const hive::OutputStatus& output) {
                  return output.last_emitted_us > now_us - second_us;
              });
}

}  // namespace

std::string activity_text(const hive::Status& status)
{
    return is_sending(status) ? "sending" : std::string(token(status.state));
}

std::string source_text(const hive::Status& status)
{
    if (status.source_events <= 0 || status.outputs.empty())
        return {};
    const auto most = std::ranges::max(status.outputs, {}, &hive::OutputStatus::produced).produced;
    return std::to_string(std::min(most, status.source_events)) + " of " + std::to_string(status.source_events);
}

void show_activity(Row& row, const hive::Status& status)
{
    row.set("state", activity_text(status)).add("done", source_text(status));
}

}  // namespace hivectl
