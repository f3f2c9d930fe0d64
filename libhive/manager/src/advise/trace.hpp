// Finds the paths of events from the status of the drones.
#pragma once

#include "../explain/look.hpp"

#include <string>
#include <vector>

namespace hive::advising {

/// The drones of one step, and the input at which they receive.
struct Step {
    std::vector<std::string> members{};  ///< by the names that the application uses
    std::string from{};                  ///< "camera.image"; empty: the source
    std::string input{}, group{};
    std::vector<std::string> senders{};  ///< the members of the step before
};

/// @param drones  as of advise()
/// @return  each path, the source first
std::vector<std::vector<Step>> trace(const explaining::Look& look, const std::vector<std::string>& drones);

/// The rows of its connections at a member: one per sender, if several drones share the step before. Not those of other
/// senders.
std::vector<const InputStatus*> inputs_of(const Status& member, const Step& step);
/// The row at the sender of a member, or of the group as a whole; null: missing.
const EdgeStatus* edge_of(const Status& sender, const Step& step, const std::string& member);

}  // namespace hive::advising
