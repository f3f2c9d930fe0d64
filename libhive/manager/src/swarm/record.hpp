// What a home remembers of a swarm: the plan that was brought up last, in NAME.swarm.
#pragma once

#include <hive/swarm_plan.hpp>

#include <filesystem>
#include <optional>
#include <vector>

namespace hive::swarm {

class Record {
public:
    Record(std::filesystem::path home, const std::string& swarm);

    /// Empty without one.
    [[nodiscard]] std::string text() const;
    /// Without one: a plan of the same name and nothing else.
    [[nodiscard]] SwarmPlan read() const;
    /// Whole or not at all. Throws Errc::io.
    void write(const SwarmPlan& plan) const;
    void forget() const noexcept;

    /// Of all swarms of a home, by name.
    static std::vector<SwarmPlan> all(const std::filesystem::path& home);

private:
    std::string swarm_;
    std::filesystem::path file_;
};

/// The first, and what only the second has: as long as not all of that is ended it is not forgotten.
SwarmPlan with_rest_of(SwarmPlan plan, const SwarmPlan& before);

/// What a `down` that failed leaves: the drones that it could not end, which nobody is to start again.
SwarmPlan not_ended(SwarmPlan plan, const std::vector<SwarmFailure>& failures);

}  // namespace hive::swarm
