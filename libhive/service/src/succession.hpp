// Takes over the name of a running drone, once this process is ready to work.
#pragma once

#include <hive/event/home.hpp>
#include <hive/event/module.hpp>

namespace hive::service {

/// The user thread of a drone whose module has started and does not listen yet. Returns with the name in `claim`; the
/// old holder has ended. Until the old holder has answered, errors are thrown: Errc::timeout after `ready_by`,
/// Errc::name_taken when another process is about to take over. Later only Errc::stopped: it was told to stop, and is
/// not to be continued.
/// @param succession  to be released when this process listens: until then others wait for that
/// @return had the old drone halted?
bool take_over(event::Module& module, const event::Home& home, std::optional<event::NameClaim>& claim,
               std::optional<event::NameClaim>& succession, event::Clock::time_point ready_by);

}  // namespace hive::service
