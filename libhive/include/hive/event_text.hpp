// Converts an event's header to text and back, for events kept outside of the swarm (recordings).
#pragma once

#include <hive/event.hpp>

#include <string>
#include <string_view>

namespace hive {

/// The header as the protocol writes it (SPEC.md, section 5.3): identity, sender, type, size, hops, the author's
/// header. Where and when the event arrived is not in it.
std::string event_text(const Event& event);

/// The event of such a text. Throws Errc::malformed, Errc::too_large.
/// @param body  empty when the event was kept without its body; `size` then says that there was one
Event event_from_text(std::string_view text, Body body = {});

}  // namespace hive
