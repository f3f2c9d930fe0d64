// Does what drones tell of themselves add up? Pure: from statuses to what is wrong with them.
#pragma once

#include "plan.hpp"
#include "status_of.hpp"

#include <set>

namespace hive::mixtures {

using Problems = std::vector<std::string>;

/// Every account by itself, at any time.
Problems unbalanced(const Statuses& statuses);
/// Fields of one status that cannot be true together, at any time.
Problems contradictory(const Statuses& statuses);
/// The two ends of each edge beside each other, when nothing moves.
/// @param born  numbers the starts of drones: an end that began later has counted less
Problems disagreeing(const Statuses& statuses, const std::map<std::string, int>& born);
/// Nothing is under way anywhere.
/// @param but_for_partners  not counting what a drone that joins has, if its partners may have been lost
bool idle(const Statuses& statuses, bool but_for_partners = false);
/// Is there a word for why this source stands still?
bool says_why(const Status& status);
/// Edges with events under way for which there is no word, when nothing moves. A receiver that does not answer may be
/// frozen, and its sender need not know yet: that is left out.
Problems without_reason(const Statuses& statuses);
/// Edges whose reason cannot be true, when nothing moves.
Problems with_false_reason(const Statuses& statuses);
/// Inputs that a drone should not have, and such that it should: what it was told outlives a crash.
/// @param wanted  sender and receiver
Problems wrongly_connected(const Statuses& statuses, const std::set<std::pair<std::string, std::string>>& wanted);
/// Halted drones that run although they were not resumed.
Problems wrongly_resumed(const Statuses& statuses, const std::set<std::string>& halted);
/// Are these two connected, at both ends?
bool connected(const Statuses& statuses, const Edge& edge);
/// How many applications receive the results of this drone.
std::int64_t collectors_of(const Statuses& statuses, const std::string& drone);
/// Does an application receive each of its outputs?
bool all_collected(const Statuses& statuses, const std::string& drone);
/// Is the hearer connected, so that it hears the exceptions of this drone? A collector in order hears them as well.
bool heard(const Statuses& statuses, const std::string& drone);
/// Exceptions that these drones have told and the hearer has not got.
std::int64_t unheard(const Statuses& statuses);

}  // namespace hive::mixtures
