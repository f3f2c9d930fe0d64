#include "numbering.hpp"

#include <iterator>

namespace hive::mixtures {

void Numbering::began(std::int64_t epoch)
{
    runs_.insert(epoch);
    made_before_[epoch] = 0;
}

std::int64_t Numbering::run_of(std::int64_t epoch) const { return *std::prev(runs_.upper_bound(epoch)); }

std::vector<Outcome> Numbering::numbered(std::vector<Outcome> outcomes)
{
    for (const auto& outcome : outcomes)
        if (outcome.index > 0)
            made_before_.try_emplace(outcome.epoch, outcome.index - outcome.sequence);
    outcomes.insert(outcomes.begin(), waiting_.begin(), waiting_.end());
    waiting_.clear();
    std::vector<Outcome> numbered;
    for (auto& outcome : outcomes)
        if (const auto before = made_before_.find(outcome.epoch); before == made_before_.end()) {
            waiting_.push_back(std::move(outcome));
        } else {
            outcome.epoch = run_of(outcome.epoch);
            outcome.sequence += before->second;
            numbered.push_back(std::move(outcome));
        }
    return numbered;
}

}  // namespace hive::mixtures
