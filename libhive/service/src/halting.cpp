// Halts a drone and resumes it.
#include "halting.hpp"

#include <hive/event/ticket.hpp>

namespace hive::service {

void Halting::halt()
{
    board_.halt();
    module_.halt(true);
    mailbox_.discard(event::came_to_member);  // others may do it meanwhile
    mailbox_.nudge();
}

void Halting::resume()
{
    mailbox_.discard([](const Event& event) { return !event.identity.lossless; });
    board_.resume();
    module_.halt(false);
    mailbox_.nudge();  // what was asked for meanwhile has not woken main
}

}  // namespace hive::service
