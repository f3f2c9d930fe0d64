// Refuses second answers and puts what arrives into the mailbox.
#include "inbox.hpp"

#include <hive/event/receipt.hpp>

namespace hive::service {

void Inbox::arrived(Event&& event)
{
    if (filters_[event.input].first(event))
        mailbox_.push(std::move(event));
    else
        conclude(event, event::Ending::duplicate);
}

void Inbox::discard(const event::Intake& intake)
{
    mailbox_.discard([&](const Event& event) { return came_over(event, intake); });
}

void Inbox::command(Command command)
{
    mailbox_.push([&worker = worker_, command = std::move(command)] { command(worker); });
}

}  // namespace hive::service
