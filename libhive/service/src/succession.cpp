// Asks the running drone to hand over, and waits until the kernel frees the name.
#include "succession.hpp"

#include "shutdown_watchdog.hpp"

namespace hive::service {
namespace {

using event::Clock;
using namespace std::chrono_literals;

constexpr auto ask_timeout = 5s;
constexpr auto name_timeout = ShutdownWatchdog::hand_over_timeout + 5s;

/// A drone that has ended, or ends before it answers, frees the name too.
bool is_refusal(const Error& error)
{
    return error.code() == Errc::refused || error.code() == Errc::not_permitted
           || error.code() == Errc::invalid_argument;
}

/// @return its answer; nothing if it has none
std::optional<Json> ask_to_hand_over(event::Module& module, const event::Home& home)
{
    const auto outcome = std::make_shared<std::optional<event::Outcome>>();
    const auto deadline = Clock::now() + ask_timeout;
    module.post([&module, address = home.address(module.self().name), deadline, outcome] {
        module.request(address, protocol::PacketType::stop, Json{{"successor", true}}, {}, deadline,
                       [outcome](const event::Outcome& told) { *outcome = told; });
    });
    module.loop().wait(deadline + 1s, [&] { return outcome->has_value(); });
    if (!*outcome)
        return std::nullopt;
    const auto* error = error_of(**outcome);
    if (error && is_refusal(*error))
        throw *error;
    return error ? std::nullopt : std::optional(std::get<Json>(**outcome));
}

/// Asks until there is an answer, since one that was restarted meanwhile may not listen yet. One that has ended need
/// not be asked. @return had it halted?
bool hand_over(event::Module& module, const event::Home& home, Clock::time_point ready_by)
{
    const auto& name = module.self().name;
    while (home.alive(name)) {
        if (const auto answer = ask_to_hand_over(module, home))
            return Fields(*answer, "the answer to stop").flag_or("halted", false);
        if (Clock::now() > ready_by)
            throw Error(Errc::timeout, name + " runs, as process " + std::to_string(home.holder(name))
                                           + ", and did not answer in time");
        module.loop().wait(Clock::now() + 10ms, [] { return false; });
    }
    return false;
}

/// A file lock does not signal its release, so it is polled every millisecond.
void await_name(event::Module& module, const event::Home& home, std::optional<event::NameClaim>& claim)
{
    const auto& name = module.self().name;
    const auto until = Clock::now() + name_timeout;
    while (!claim)
        try {
            if (Clock::now() < until && home.alive(name))
                module.loop().wait(Clock::now() + 1ms, [] { return false; });
            else
                claim.emplace(home, name);
        } catch (const Error& error) {
            if (error.code() != Errc::name_taken || Clock::now() >= until)
                throw;
        }
}

}  // namespace

bool take_over(event::Module& module, const event::Home& home, std::optional<event::NameClaim>& claim,
               std::optional<event::NameClaim>& succession, event::Clock::time_point ready_by)
{
    const auto& name = module.self().name;
    succession.emplace(home, name, event::NameClaim::To::succession);
    if (Clock::now() > ready_by)
        throw Error(Errc::timeout, "it was not ready in time to take over " + name);
    const bool halted = hand_over(module, home, ready_by);
    await_name(module, home, claim);
    if (!home.has_state(name))
        throw Error(Errc::stopped, name + " was stopped while it was being replaced");
    return halted;
}

}  // namespace hive::service
