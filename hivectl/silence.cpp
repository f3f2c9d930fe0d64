// Asks the senders for their state and their condition.
#include "silence.hpp"

#include "format.hpp"
#include "output.hpp"
#include "targets.hpp"

namespace hivectl {
namespace {

using namespace std::chrono_literals;

/// Empty for one that has nothing to say.
std::string state_of(const hive::Answer& answer)
{
    if (answer.error)
        return explained(*answer.error);
    const auto condition = text_in(answer.result, "condition");
    const std::string halted = text_in(answer.result, "state") == "halted" ? "halted" : "";
    const std::string both = halted + (halted.empty() || condition.empty() ? "" : ", ") + printable(condition);
    return both.empty() ? "" : answer.drone + ": " + both;
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
