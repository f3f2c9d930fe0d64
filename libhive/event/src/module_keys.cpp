// Watches the swarm's keys while a module runs: logs rejected peers, and closes links whose key became invalid, or
// which could have a better one.
#include <hive/event/module.hpp>

#include <vector>

namespace hive::event {
namespace {

constexpr auto look_at_keys_every = std::chrono::milliseconds(1000);

}  // namespace

transport::Security Module::security()
{
    return {.keys = options_.keys, .refused = [this](const std::string& who) {
                if (const auto left_out = refusals_.pass("", Clock::now()))
                    log(LogLevel::warning, who + left_out_text(*left_out));
            }};
}

/// Checks once per second as long as a link depends on a key.
void Module::watch_keys()
{
    if (watching_keys_ || ending_)
        return;
    watching_keys_ = true;
    keys_timer_.run_after(look_at_keys_every, [this] {
        watching_keys_ = false;
        recheck_keys();
    });
}

void Module::recheck_keys()
{
    bool needed = false;
    for (const auto& link : std::vector(links_)) {
        const auto& [role, key] = link->credentials();
        if (key.empty())
            continue;
        needed = true;
        if (!options_.keys->accepts(key, role))
            link->close(Error(Errc::not_permitted, "the swarm key " + key + " has expired"));
        else if (role == Role::viewer && link->dialed() && !options_.keys->offers(key, role))
            link->close(Error(Errc::connection_lost, "a members' key has replaced the viewers' key " + key));
    }
    if (options_.keys && options_.keys->trouble() != keys_error_) {
        keys_error_ = options_.keys->trouble();
        if (!keys_error_.empty())
            log(LogLevel::warning, keys_error_ + "; the known keys stay valid");
    }
    if (needed)
        watch_keys();
}

}  // namespace hive::event
