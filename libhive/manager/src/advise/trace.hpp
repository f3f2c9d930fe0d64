// Which drones are on the way of events, from what drones report.
#pragma once

#include "../explain/look.hpp"

#include <string>
#include <vector>

namespace hive::advising {

/// Drones that do one step, and the input at which they receive.
struct Step {
    std::vector<std::string> members{};  ///< as the application calls them
    std::string from{};                  ///< "camera.image"; empty: the source
    std::string input{}, group{};
};

/// @param drones  as of advise()
/// @return  each way, the source first
std::vector<std::vector<Step>> trace(const explaining::Look& look, const std::vector<std::string>& drones);

/// The rows of its connections at a member: one for each sender, if several drones do the step before.
std::vector<const InputStatus*> inputs_of(const Status& member, const Step& step);
/// The row at the sender of a member, or of the group as a whole; null: it is not there.
const EdgeStatus* edge_of(const Status& sender, const Step& step, const std::string& member);
/// "image" of "camera.image".
std::string port_of(const std::string& end);

}  // namespace hive::advising
