// Inputs whose events are brought together before the user's code sees them.
#include "drone_core.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hive {

const MatchedInput* DroneCore::MatchedInputs::input(const std::string& name) const
{
    const auto found = std::ranges::find(inputs, name, &MatchedInput::name);
    return found == inputs.end() ? nullptr : &*found;
}

std::size_t DroneCore::add_matching(const std::vector<MatchedInput>& inputs, Match match,
                                    std::function<void(const std::vector<Event>&)> callback)
{
    std::vector<std::string> names;
    for (const auto& input : inputs) {
        interface.inputs.push_back({require_name(input.name, "input"), input.type, input.help});
        names.push_back(input.name);
    }
    interface.stateful = program_.stateful = true;
    matchings.push_back({inputs, event::Matcher(names, match), std::move(callback)});
    board_.matched.emplace_back();
    return matchings.size() - 1;
}

void DroneCore::to_partners(Event event, MatchedInputs& matching, const MatchedInput& input)
{
    Set single;
    single.push_back(std::move(event));
    const auto check = [&] {
        require_type(single.front());
        if (input.check)
            input.check(single.front());
    };
    if (work(single, check))
        matching.matcher.push(std::move(single.front()), Clock::now());
}

void DroneCore::work_on_sets()
{
    for (std::size_t i = 0; i < matchings.size(); ++i) {
        auto& [inputs, matcher, callback] = matchings[i];
        matcher.expire(Clock::now());
        while (!halted_ && !stopping_)
            if (const auto set = matcher.pop()) {
                if (work(*set, [&] { callback(*set); }))
                    processed(*set);
            } else {
                break;
            }
        const std::lock_guard lock(board_mutex_);
        board_.matched[i] = matcher.counts();
    }
}

std::vector<MatchingStatus> DroneCore::matching_status(const Board& board) const
{
    std::vector<MatchingStatus> rows;
    for (std::size_t i = 0; i < matchings.size(); ++i) {
        const MatchCounts& counts = board.matched[i];
        MatchingStatus& row = rows.emplace_back(MatchingStatus{.sets = counts.sets,
                                                               .waiting = counts.waiting,
                                                               .unmatched = counts.unmatched,
                                                               .duplicates = counts.duplicates,
                                                               .missing = counts.missing});
        for (const auto& input : matchings[i].inputs) {
            row.inputs.push_back(input.name);
            row.missing.try_emplace(input.name, 0);
        }
    }
    return rows;
}

}  // namespace hive
