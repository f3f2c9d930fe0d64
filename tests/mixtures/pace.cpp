// Whether the same event has been due for too long.
#include "pace.hpp"

#include <utility>

namespace hive::mixtures {

Problems Pace::look(const Statuses& statuses, std::int64_t fed, Time now)
{
    std::optional<Due> due;
    if (const auto found = statuses.find(source); found != statuses.end() && !found->second.outputs.empty()) {
        const auto& [status, output] = std::tie(found->second, found->second.outputs.front());
        const bool may = status.state != State::stopping && status.why == Reason::none && output.why == Reason::none;
        if (may && output.produced < fed)
            due = Due{status.epoch, output.produced};
    }
    const bool followed = now - std::exchange(looked_, now) < limit_;
    if (std::exchange(due_, due) != due || !followed)
        since_ = now;
    if (!due || now - since_ <= limit_)
        return {};
    const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(now - since_).count();
    return {"pace: all have asked, and the source has not produced event " + std::to_string(due->produced + 1) + " for "
            + std::to_string(waited) + " ms"};
}

}  // namespace hive::mixtures
