// Which of two runs of a source was earlier, for those who receive its events through other drones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace hive::event {

/// The order of the runs of each source: by epoch, unless a sender that keeps the order of events is the first to send
/// one of a run, and so shows that the clock was set back before it. Pure logic, for one thread.
class Runs {
public:
    static constexpr std::size_t most_sources = 64;
    static constexpr std::size_t most_runs = 64;  ///< of a source; those that are forgotten come first, by epoch

    /// An event of this run has come. @param before  the run of its sender's event before that; 0: unknown, or the
    /// sender keeps no order
    void hear(const std::string& source, std::int64_t epoch, std::int64_t before);
    [[nodiscard]] bool precedes(const std::string& source, std::int64_t one, std::int64_t other) const;

private:
    std::map<std::string, std::vector<std::int64_t>> runs_;
};

}  // namespace hive::event
