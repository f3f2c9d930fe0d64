// Asks the senders for their state and their condition.
#include "silence.hpp"

#include "output.hpp"
#include "reasons.hpp"
#include "targets.hpp"

namespace hivectl {
namespace {

using namespace std::chrono_literals;

/// Empty for one that has nothing to say.
std::string state_of(const hive::StatusAnswer& answer)
{
    if (answer.error)
        return explained(*answer.error);
    std::string text;
    for (const auto& part : {std::string(answer.status.state == hive::State::halted ? "halted" : ""),
                             printable(answer.status.condition), printable(standstill(answer.status))})
        text += (text.empty() || part.empty() ? "" : ", ") + part;
    return text.empty() ? "" : answer.drone + ": " + text;
}

}  // namespace

std::string reason_for_silence(hive::Application& application, const std::vector<hive::Endpoint>& outputs)
{
    std::vector<std::string> drones;
    for (const auto& output : outputs)
        add_new(drones, {output.drone});
    application.timeout(500ms);
    std::string text;
    for (const auto& answer : application.status(drones))
        if (const auto state = state_of(answer); !state.empty())
            text += state + "; ";
    return text + "see what is connected: hivectl edges";
}

}  // namespace hivectl
