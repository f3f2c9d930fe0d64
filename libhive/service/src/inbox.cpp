// Puts what arrives into the mailbox, and takes back what was not begun.
#include "inbox.hpp"

#include <hive/event/ticket.hpp>

namespace hive::service {

void Inbox::arrived(Event&& event) { mailbox_.push(std::move(event)); }

void Inbox::discard(const event::Intake& intake)
{
    mailbox_.discard([&](const Event& event) { return came_over(event, intake); });
}

void Inbox::command(Command command)
{
    mailbox_.push([&worker = worker_, command = std::move(command)] { command(worker); });
}

}  // namespace hive::service
