// Keeps a list of runs for each source.
#include <hive/event/runs.hpp>

#include <algorithm>
#include <iterator>

namespace hive::event {

void Runs::hear(const std::string& source, std::int64_t epoch, std::int64_t before)
{
    if (epoch == before)
        return;
    auto& runs = runs_[source];
    if (std::ranges::count(runs, epoch) > 0)
        return;
    const auto after = std::ranges::find(runs, before);
    const auto from = after == runs.end() ? runs.begin() : std::next(after);
    runs.insert(std::find_if(from, runs.end(), [&](std::int64_t each) { return each > epoch; }), epoch);
    if (runs.size() > most_runs)
        runs.erase(runs.begin());
    if (runs_.size() > most_sources)
        runs_.erase(runs_.begin()->first == source ? std::next(runs_.begin()) : runs_.begin());
}

bool Runs::precedes(const std::string& source, std::int64_t one, std::int64_t other) const
{
    const auto runs = runs_.find(source);
    const auto position = [&](std::int64_t epoch) {
        const auto found = std::ranges::find(runs->second, epoch);
        return found == runs->second.end() ? -1 : found - runs->second.begin();
    };
    if (runs == runs_.end() || position(one) == position(other))
        return one < other;
    return position(one) < position(other);
}

}  // namespace hive::event
