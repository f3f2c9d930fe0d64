// Reports a drone's state in the form of sd_notify(3).
#include "supervised.hpp"

#include <hive/platform/supervisor.hpp>
#include <hive/printable.hpp>

namespace hive::service {

/// Repeatedly, since a message is lost if the supervisor's queue is full.
void Supervised::ready()
{
    if (ended_)
        return;
    tell("READY=1\nWATCHDOG=1");
    if (const auto timeout = platform::supervisor_timeout(); timeout && speaks_)
        timer_.run_after(*timeout / 3, [this] { ready(); });
}

void Supervised::end()
{
    ended_ = true;
    timer_.cancel();
}

void Supervised::status(const std::string& text) const { tell("STATUS=" + printable(text)); }

void Supervised::tell(const std::string& news) const
{
    if (speaks_)
        platform::tell_supervisor(news);
}

}  // namespace hive::service
