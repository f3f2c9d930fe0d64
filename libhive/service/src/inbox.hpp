// What the network side hands to the user thread: events that arrived, and commands.
#pragma once

#include "worker.hpp"

#include <hive/event/sequence_filter.hpp>

namespace hive::service {

/// The network side.
class Inbox {
public:
    using Command = std::function<void(Worker&)>;

    Inbox(event::Mailbox& mailbox, StatusBoard& board, Worker& worker)
        : mailbox_(mailbox), board_(board), worker_(worker)
    {
    }

    /// @param intake  where it came from; none for an event that an application put
    void arrived(Event&& event, const std::weak_ptr<event::Intake>& intake = {});
    /// Runs on the user thread, between callbacks and before any event that waits.
    void command(Command command);

private:
    event::Mailbox& mailbox_;
    StatusBoard& board_;
    Worker& worker_;  ///< for commands alone
    event::SequenceFilter filter_;
};

}  // namespace hive::service
