// What is counted as lost is counted with its cause.
#pragma once

#include "checks.hpp"
#include "model.hpp"

#include <functional>

namespace hive::mixtures {

/// fates: events are lost at a killed or leaving drone only if an order or a fault has killed it or ended its
/// connection; they are cut off only if a drone was frozen or unheard; an event is given up only after one of these.
class Fates {
public:
    /// Has the network ended a connection of these two as if one had died?
    using WasCut = std::function<bool(const std::string& drone, const std::string& peer)>;

    /// @param topology  its drones are known, with those that collect; others come and go
    /// @param silent    a drone may be unheard for 2 s although no order says so
    Fates(const Topology& topology, WasCut was_cut, bool silent);

    void before(const Step& step);
    [[nodiscard]] Problems look(const Statuses& statuses) const;
    [[nodiscard]] std::optional<std::string> came(const Outcome& outcome) const;

private:
    WasCut was_cut_;
    std::set<std::string> known_, may_die_, may_leave_;
    bool silent_;
};

}  // namespace hive::mixtures
