// Asks the senders for their state and their condition, against the direction of the events.
#include "silence.hpp"

#include "output.hpp"
#include "reasons.hpp"
#include "targets.hpp"

#include <algorithm>

namespace hivectl {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t most_asked = 64;

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

/// The drones that it receives from.
std::vector<std::string> senders_of(const hive::Status& status)
{
    std::vector<std::string> drones;
    for (const auto& input : status.inputs)
        add_new(drones, {input.from.substr(0, input.from.rfind('.'))});
    return drones;
}

bool holds(const hive::Status& status)
{
    return std::ranges::any_of(status.outputs,
                               [](const hive::OutputStatus& output) { return output.why == hive::Reason::held; });
}

}  // namespace

Standstill standstill_behind(hive::Application& application, const std::vector<hive::Endpoint>& outputs)
{
    std::vector<std::string> drones;
    for (const auto& output : outputs)
        add_new(drones, {output.drone});
    application.timeout(500ms);
    Standstill result;
    for (std::size_t asked = 0; asked < std::min(drones.size(), most_asked);) {
        const std::vector<std::string> next(drones.begin() + static_cast<std::ptrdiff_t>(asked), drones.end());
        asked = drones.size();
        for (const auto& answer : application.status(next)) {
            if (const auto state = state_of(answer); !state.empty())
                result.text += (result.text.empty() ? "" : "; ") + state;
            if (answer.error)
                continue;
            result.held = result.held || holds(answer.status);
            add_new(drones, senders_of(answer.status));
        }
    }
    return result;
}

std::string reason_for_silence(hive::Application& application, const std::vector<hive::Endpoint>& outputs)
{
    const auto text = standstill_behind(application, outputs).text;
    return text + (text.empty() ? "" : "; ") + "see what is connected: hivectl edges";
}

void tell_standstill(const std::string& verb, hive::Application& application,
                     const std::vector<hive::Endpoint>& outputs)
{
    if (const auto text = standstill_behind(application, outputs).text; !text.empty())
        complain(verb, "nothing comes: " + text);
}

}  // namespace hivectl
