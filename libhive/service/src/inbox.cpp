// Filters and counts what arrives, and puts it into the mailbox.
#include "inbox.hpp"

namespace hive::service {

void Inbox::arrived(Event&& event, const std::weak_ptr<event::Intake>& weak)
{
    const bool fresh = filter_.first(event);
    const auto dropped = fresh ? mailbox_.push(std::move(event)) : 0;
    board_.arrived(fresh, dropped);
    if (const auto intake = weak.lock())
        intake->lost += static_cast<std::int64_t>(dropped);
}

void Inbox::command(Command command)
{
    mailbox_.push([&worker = worker_, command = std::move(command)] { command(worker); });
}

}  // namespace hive::service
