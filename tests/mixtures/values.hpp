// Which values the workers' parameters may have, after what was set and what was answered.
#pragma once

#include <compare>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace hive::mixtures {

struct Setting {
    int work_ms = 0, most_ms = 0;
    auto operator<=>(const Setting&) const = default;
};
using Settings = std::map<std::string, Setting>;  ///< by drone

/// What was to be set; a drone refuses a work_ms above its most_ms.
struct Change {
    std::vector<std::string> drones;
    int work_ms = 0;
    std::optional<int> most_ms;
};

/// What the asker was told of it.
enum class Told { applied, refused, unknown };

/// Keeps every state of all drones together that agrees with what was told. Pure logic.
class Values {
public:
    void began(const std::string& drone, Setting setting);
    /// Says what is wrong when the answer cannot be.
    /// @param killed  a drone that was killed meanwhile: it has the old values or the new ones, whatever the others
    /// have
    std::optional<std::string> set(const Change& change, Told told, const std::string& killed = {});
    /// Of two at once: each order may be the one.
    void set_both(const Change& one, Told told_one, const Change& other, Told told_other);
    /// Says what is wrong when no state that may be has these values. Afterwards only those that have remain.
    std::optional<std::string> found(const Settings& actual);

private:
    std::set<Settings> possible_{Settings{}};
};

}  // namespace hive::mixtures
