// The words of sd_notify(3) for what happens to a drone.
#include "supervised.hpp"

#include <hive/platform/supervisor.hpp>
#include <hive/printable.hpp>

namespace hive::service {

void Supervised::ready()
{
    platform::tell_supervisor("READY=1");
    alive();
}

void Supervised::stopping() { platform::tell_supervisor("STOPPING=1"); }

void Supervised::status(const std::string& text) { platform::tell_supervisor("STATUS=" + printable(text)); }

void Supervised::alive()
{
    const auto patience = platform::patience_of_supervisor();
    if (!patience)
        return;
    platform::tell_supervisor("WATCHDOG=1");
    timer_.run_after(*patience / 3, [this] { alive(); });
}

}  // namespace hive::service
