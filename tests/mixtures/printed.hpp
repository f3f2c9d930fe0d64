// What `hivectl results` printed, and whether its exit code says the truth about it.
#pragma once

#include "checks.hpp"
#include "model.hpp"

namespace hive::mixtures {

struct Printed {
    int exit_code = 0;
    std::string complaints;                                          ///< its other lines
    std::map<std::pair<std::int64_t, std::int64_t>, int> results{};  ///< lines of each epoch and sequence
};
Printed printed_in(const std::string& log, int exit_code);

/// The last run of the source, after its end.
struct LastRun {
    std::int64_t epoch = 0, produced = 0;
    bool lossless = false;
    bool first = false;  ///< there was none before
};

/// command: no result is printed twice. The exit code is 0 or 8: not 0 if a result of the last run was printed less
/// often than it was collected, and not 8 if each event gave its results and no exception.
Problems wrongly_printed(const Printed& printed, const Model& model, const LastRun& run);

}  // namespace hive::mixtures
