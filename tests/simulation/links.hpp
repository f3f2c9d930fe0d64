// Tracks which links between the drones of a round may end, and which have ended.
#pragma once

#include "world.hpp"

#include <set>
#include <utility>

namespace hive::simulation {

/// links: a link ends only by a fault at one of its ends. The caller reports faults as they happen, and the log lines
/// of drones report ended links.
class Links {
public:
    /// The peers that stay for the whole round, apart from faults.
    explicit Links(std::set<std::string> names) : names_(std::move(names)) {}

    /// From now on the peer may lose its links.
    void broken(const std::string& name, Time now) { faults_.push_back({name, {}, now, Time::max()}); }
    /// It is healthy; soon it will have detected what has happened.
    void mended(const std::string& name, Time now);
    void cut(const std::string& one, const std::string& other, Time now)
    {
        faults_.push_back({one, other, now, now + notice});
    }

    /// That peer may break rules, and have any name.
    void lies(std::int64_t pid) { liars_.insert("pid " + std::to_string(pid) + ":"); }

    void silent(const std::string& one, const std::string& other, Time now, Time until)
    {
        faults_.push_back({one, other, now, until + notice});
    }

    /// It may lose its links if it sends nothing for too long.
    void frozen(const std::string& name, Time now);
    void thawed(const std::string& name, Time now);

    /// @param line  as the drone has logged it
    void logged(const std::string& drone, const std::string& line, Time now);
    std::vector<std::string> take_problems() { return std::exchange(problems_, {}); }

private:
    static constexpr auto notice = std::chrono::seconds(1);

    struct Fault {
        std::string one, other;  ///< of a cut; otherwise there is no other, and all links of the one may end
        Time from, until;
    };
    struct Freeze {
        Time since, until;
    };
    [[nodiscard]] bool may_end(const std::string& one, const std::string& other, Time now) const;

    std::set<std::string> names_, liars_;
    std::vector<Fault> faults_;
    std::map<std::string, Freeze> freezes_;  ///< the last of each
    std::vector<std::string> problems_;
};

}  // namespace hive::simulation
