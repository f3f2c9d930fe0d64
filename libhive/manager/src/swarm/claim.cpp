// Uses a lock file as those of drones, NAME.swarm.lock; a waiting process holds NAME.swarm.next.
#include "claim.hpp"

#include "../inquiry.hpp"
#include "../swarm_file/words.hpp"

#include <hive/error.hpp>
#include <hive/event/clock.hpp>

#include <algorithm>

namespace hive::swarm {

using namespace std::chrono_literals;

namespace {

Claim claim_unless_taken(const event::Home& home, const std::string& swarm, event::NameClaim::To what)
try {
    return std::make_unique<const event::NameClaim>(home, swarm_file::lock_of(swarm), what);
} catch (const Error& error) {
    if (error.code() != Errc::name_taken)
        throw;
    return nullptr;
}

}  // namespace

Claim claim(Application& application, const std::string& swarm, std::chrono::milliseconds timeout,
            const SwarmWatch& watch)
{
    const event::Home directory(application.home());
    const auto begin = event::Clock::now(), end = begin + std::max<std::chrono::milliseconds>(timeout, 1s);
    Claim waiting;
    // A file lock does not signal its release, so it is polled.
    for (bool told = !watch.told;; Inquiry(application).wait(event::Clock::now() + 10ms, {})) {
        if (auto claim = claim_unless_taken(directory, swarm, event::NameClaim::To::name))
            return claim;
        if (watch.cancelled && watch.cancelled())
            return nullptr;
        const auto now = event::Clock::now();
        if (!told && now - begin >= 1s) {
            told = true;
            watch.told("another process is changing the swarm " + swarm + " now; waiting until that is done");
        }
        if (now >= end)
            throw Error(Errc::locked, "another process is changing the swarm " + swarm + " now",
                        "try again when that is done, or wait longer: --timeout SECONDS");
        if (!waiting)
            waiting = claim_unless_taken(directory, swarm, event::NameClaim::To::succession);
    }
}

Claim claim_if_free(const std::filesystem::path& home, const std::string& swarm)
{
    return claim_is_wanted(home, swarm) ? nullptr
                                        : claim_unless_taken(event::Home(home), swarm, event::NameClaim::To::name);
}

bool claim_is_wanted(const std::filesystem::path& home, const std::string& swarm)
{
    return event::Home(home).succession(swarm_file::lock_of(swarm));
}

}  // namespace hive::swarm
