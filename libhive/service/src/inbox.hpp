// What the network side hands to the user thread: events that arrived, and commands.
#pragma once

#include "worker.hpp"

namespace hive::service {

/// The network side.
class Inbox {
public:
    using Command = std::function<void(Worker&)>;

    Inbox(event::Mailbox& mailbox, Worker& worker) : mailbox_(mailbox), worker_(worker) {}

    void arrived(Event&& event);
    /// Takes back what came over a connection and was not begun.
    void discard(const event::Intake& intake);
    /// Runs on the user thread, between callbacks and before any event that waits.
    void command(Command command);

private:
    event::Mailbox& mailbox_;
    Worker& worker_;  ///< for commands alone
};

}  // namespace hive::service
