// Comparing what a drone had done when it began to wait with what it has done since.
#include "waits.hpp"

#include <algorithm>

namespace hive::mixtures {
namespace {

std::int64_t sum_of_inputs(const Status& status, std::int64_t (*count)(const InputStatus&))
{
    std::int64_t sum = 0;
    for (const auto* rows : {&status.inputs, &status.left})
        for (const auto& row : *rows)
            sum += count(row);
    return sum;
}

/// Events that the drone's code has finished with.
std::int64_t worked(const Status& status)
{
    return sum_of_inputs(status, [](const InputStatus& input) { return input.processed + input.abandoned; });
}

/// Its code may have finished with them already, and only the count comes later.
std::int64_t in_hand(const Status& status)
{
    return sum_of_inputs(status, [](const InputStatus& input) { return input.in_hand; });
}

std::int64_t produced(const Status& status) { return status.outputs.empty() ? 0 : status.outputs.front().produced; }

bool halted(const Status& was, const Status& is) { return was.state == State::halted && is.state == State::halted; }

/// The same place: whoever takes it up again registers again.
bool keeps_place(const Status& was, const Status& is)
{
    if (was.outputs.empty() || is.outputs.empty())
        return false;
    const auto kept = [](const EdgeStatus& edge) { return !edge.connected && edge.why == Reason::place_kept; };
    const auto& before = was.outputs.front().edges;
    return std::ranges::any_of(is.outputs.front().edges, [&](const EdgeStatus& edge) {
        return kept(edge) && std::ranges::any_of(before, [&](const EdgeStatus& old) {
                   return kept(old) && old.receiver == edge.receiver && old.registration == edge.registration;
               });
    });
}

}  // namespace

Problems Waits::look(const Statuses& statuses)
{
    Problems problems;
    const auto require_same = [&](std::int64_t before, std::int64_t now, const std::string& what,
                                  std::int64_t late = 0) {
        if (now < before || now > before + late)
            problems.push_back("waits: " + what + ": " + std::to_string(before) + " before, and now "
                               + std::to_string(now));
    };
    for (const auto& [name, status] : statuses) {
        const auto found = before_.find(name);
        if (found == before_.end() || found->second.epoch != status.epoch)
            continue;
        const auto& before = found->second;
        if (halted(before, status)) {
            const auto late = in_hand(before);
            require_same(worked(before), worked(status), name + " has halted and works", late);
            require_same(produced(before), produced(status), name + " has halted and produces", late);
        } else if (name == source && lossless_ && keeps_place(before, status)) {
            require_same(produced(before), produced(status), "the source keeps a place and produces");
        }
    }
    before_ = statuses;
    return problems;
}

}  // namespace hive::mixtures
