// The record of a swarm in a home: the plan that was brought up last, in NAME.swarm.
#pragma once

#include <hive/swarm_plan.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace hive::swarm {

class Record {
public:
    Record(std::filesystem::path home, const std::string& swarm);

    /// Empty without a record.
    [[nodiscard]] std::string text() const;
    /// Without a record: a plan with only the name.
    [[nodiscard]] SwarmPlan read() const;
    /// Writes all or nothing. Throws Errc::io.
    void write(const SwarmPlan& plan) const;
    void forget() const noexcept;

    /// The records of all swarms of a home, by name.
    /// @param unreadable  gets the error of each that cannot be read; without it, that is thrown
    static std::vector<SwarmPlan> all(const std::filesystem::path& home,
                                      const std::function<void(const Error&)>& unreadable);

private:
    std::string swarm_;
    std::filesystem::path file_;
};

/// The first plan, plus what only the second has: that stays recorded until all of it is stopped.
SwarmPlan with_rest_of(SwarmPlan plan, const SwarmPlan& before);

/// The drones of a plan that could not be stopped or changed, and their connections to drones that still run.
SwarmPlan part_of(SwarmPlan plan, const std::vector<SwarmFailure>& remains, const std::vector<SwarmFailure>& silent);

/// The record after a failed `down`: the drones that it could not stop, which must not be restarted.
SwarmPlan not_ended(SwarmPlan plan, const std::vector<SwarmFailure>& failures);

}  // namespace hive::swarm
