// Halts a drone and resumes it.
#include "halting.hpp"

namespace hive::service {

void Halting::halt()
{
    board_.halt();
    module_.halt(true);
    mailbox_.nudge();
}

void Halting::resume()
{
    board_.resume(mailbox_.discard_live());
    module_.halt(false);
}

}  // namespace hive::service
