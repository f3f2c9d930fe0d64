// Asks the senders for their state and their condition, against the direction of the events.
#include <hive/printable.hpp>
#include <hive/stall.hpp>
#include <hive/stall_search.hpp>

#include <algorithm>

namespace hive {
namespace {

constexpr std::size_t max_asked = 64;

void append(std::string& text, const std::string& part, const char* separator)
{
    if (!part.empty())
        text += (text.empty() ? "" : separator) + part;
}

/// Empty for a drone that has nothing to report.
std::string state_text(const StatusAnswer& answer)
{
    std::string text = answer.status.state == State::halted ? "halted" : "";
    append(text, printable(answer.status.condition), ", ");
    append(text, printable(stall_text(answer.status)), ", ");
    return text.empty() ? "" : answer.drone + ": " + text;
}

void add_new(std::vector<std::string>& drones, const std::string& drone)
{
    if (std::ranges::find(drones, drone) == drones.end())
        drones.push_back(drone);
}

bool holds(const Status& status)
{
    return std::ranges::any_of(status.outputs, [](const OutputStatus& output) { return output.why == Reason::held; });
}

}  // namespace

Stall stall_behind(Application& application, const std::vector<Endpoint>& outputs,
                   const std::function<std::string(const Error&)>& words)
{
    std::vector<std::string> drones;
    for (const auto& output : outputs)
        add_new(drones, output.drone);
    Stall stall;
    for (std::size_t asked = 0; asked < std::min(drones.size(), max_asked);) {
        const std::vector<std::string> next(drones.begin() + static_cast<std::ptrdiff_t>(asked), drones.end());
        asked = drones.size();
        for (const auto& answer : application.status(next)) {
            append(stall.text, answer.error ? words(*answer.error) : state_text(answer), "; ");
            stall.held = stall.held || (!answer.error && holds(answer.status));
            for (const auto& input : answer.status.inputs)  // none of a drone that did not answer
                add_new(drones, input.from.substr(0, input.from.rfind('.')));
        }
    }
    return stall;
}

}  // namespace hive
