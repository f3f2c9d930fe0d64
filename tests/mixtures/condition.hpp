// What is broken at a step of a plan, as far as the plan alone can know.
#pragma once

#include "plan.hpp"

#include <map>
#include <set>

namespace hive::mixtures {

enum class Life { up, killed, stopped, frozen, halted };

class Condition {
public:
    /// All drones are up and connected.
    explicit Condition(const Topology& topology);

    void follow(const Step& step);

    [[nodiscard]] const std::map<std::string, Life>& lives() const { return lives_; }
    [[nodiscard]] Life life(const std::string& drone) const { return lives_.at(drone); }
    /// Can it answer?
    [[nodiscard]] bool runs(const std::string& drone) const;
    [[nodiscard]] std::size_t broken() const;
    /// Was the receiver told to receive from the sender, and not yet told otherwise?
    [[nodiscard]] bool connected(const std::string& sender, const std::string& receiver) const
    {
        return connected_.contains({sender, receiver});
    }

    [[nodiscard]] const std::set<std::pair<std::string, std::string>>& wanted() const { return connected_; }

private:
    std::vector<Edge> edges_;
    std::map<std::string, Life> lives_;
    std::set<std::pair<std::string, std::string>> connected_;
};

}  // namespace hive::mixtures
