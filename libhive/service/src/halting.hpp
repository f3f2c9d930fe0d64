// How a drone halts and how it resumes.
#pragma once

#include "status_board.hpp"

#include <hive/event/mailbox.hpp>
#include <hive/event/module.hpp>

namespace hive::service {

class Halting {
public:
    Halting(StatusBoard& board, event::Mailbox& mailbox, event::Module& module)
        : board_(board), mailbox_(mailbox), module_(module)
    {
    }

    /// Any thread. What is being worked on comes to its end; nothing more is begun or asked for, and shared work goes
    /// back to its group.
    void halt();
    /// The user thread. Live events that waited are discarded, so that the drone continues with the newest.
    void resume();

private:
    StatusBoard& board_;
    event::Mailbox& mailbox_;
    event::Module& module_;
};

}  // namespace hive::service
