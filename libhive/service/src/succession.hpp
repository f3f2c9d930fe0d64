// A process takes over the name of a drone that runs, once it is ready to do its work.
#pragma once

#include <hive/event/home.hpp>
#include <hive/event/module.hpp>

namespace hive::service {

/// The user thread of a drone whose module has started and that is not met by anybody yet. Returns with the name in
/// `claim`; the one that had it has ended in whatever way. Before it is asked, anything that is wrong throws:
/// Errc::timeout after `ready_by`, Errc::name_taken when another process is about to take over.
/// @return  had the other one halted?
bool take_over(event::Module& module, const event::Home& home, std::optional<event::NameClaim>& claim,
               event::Clock::time_point ready_by);

}  // namespace hive::service
