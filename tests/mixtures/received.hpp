// What a bystander has received of the source: each event once.
#pragma once

#include "checks.hpp"
#include "model.hpp"
#include "printed.hpp"

namespace hive::mixtures {

struct Received {
    std::vector<std::string> way;                                     ///< the bystanders that it has come through
    std::string what;                                                 ///< "run.hive"
    std::map<std::pair<std::int64_t, std::int64_t>, int> times = {};  ///< of each run of the source and number
    Problems wrong = {};
};

/// received: no event came twice. Of the last run of a lossless source each has come that the bystander must have.
Problems wrongly_received(const Received& received, const Model& model, const LastRun& run);

}  // namespace hive::mixtures
