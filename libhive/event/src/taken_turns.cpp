// Keeps turns as runs without a gap.
#include <hive/event/taken_turns.hpp>
#include <hive/event/ticket.hpp>

#include <algorithm>
#include <iterator>

namespace hive::event {

bool TakenTurns::take(const Event& event)
{
    const auto turn = event.identity.shares.back().turn;
    if (add(turn)) {
        owed_.emplace_back(turn, event.ticket.owed());
        if (owed_.size() > most_owed_) {
            std::erase_if(owed_, [](const auto& row) { return row.second.expired(); });
            most_owed_ = std::max<std::size_t>(64, 2 * owed_.size());
        }
        return true;
    }
    const auto before = std::ranges::find(owed_, turn, &decltype(owed_)::value_type::first);
    if (const auto owed = before == owed_.end() ? nullptr : before->second.lock(); owed && event.identity.lossless)
        owed->hold(event.ticket.owed());
    return false;
}

bool TakenTurns::add(std::int64_t turn)
{
    auto next = taken_.upper_bound(turn);
    if (next != taken_.begin()) {
        const auto before = std::prev(next);
        if (before->second >= turn)
            return false;
        if (before->second + 1 == turn) {
            before->second = turn;
            if (next != taken_.end() && next->first == turn + 1) {
                before->second = next->second;
                taken_.erase(next);
            }
            return true;
        }
    }
    std::int64_t last = turn;
    if (next != taken_.end() && next->first == turn + 1) {
        last = next->second;
        next = taken_.erase(next);
    }
    taken_.emplace_hint(next, turn, last);
    if (taken_.size() > most_gaps)
        taken_.erase(taken_.begin());
    return true;
}

}  // namespace hive::event
