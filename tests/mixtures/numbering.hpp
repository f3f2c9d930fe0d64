// Numbers of events in a run of the source: captures after an end have a new epoch and begin at 1 (SPEC.md, section
// 5.6).
#pragma once

#include "model.hpp"

#include <map>
#include <set>

namespace hive::mixtures {

class Numbering {
public:
    /// The source has started, and has this epoch until its first end.
    void began(std::int64_t epoch);
    /// The epoch of the run that an epoch belongs to.
    [[nodiscard]] std::int64_t run_of(std::int64_t epoch) const;
    /// With the epoch and the number of the run. An exception does not say its number: it waits for a result of its
    /// epoch.
    std::vector<Outcome> numbered(std::vector<Outcome> outcomes);

private:
    std::set<std::int64_t> runs_;
    std::map<std::int64_t, std::int64_t> made_before_;  ///< by epoch, in its run
    std::vector<Outcome> waiting_;
};

}  // namespace hive::mixtures
