// Asks for half a second at a time: the command is printing meanwhile.
#include "silence.hpp"

#include "exit_code.hpp"
#include "output.hpp"

namespace hivectl {

using namespace std::chrono_literals;

hive::Stall stall_behind(hive::Application& application, const std::vector<hive::Endpoint>& outputs)
{
    application.timeout(500ms);
    return hive::stall_behind(application, outputs, [](const hive::Error& error) { return explained(error); });
}

std::string reason_for_silence(hive::Application& application, const std::vector<hive::Endpoint>& outputs)
{
    const auto text = stall_behind(application, outputs).text;
    return text + (text.empty() ? "" : "; ") + "see what is connected: hivectl connections";
}

void report_stall(const std::string& verb, hive::Application& application, const std::vector<hive::Endpoint>& outputs)
{
    if (const auto text = stall_behind(application, outputs).text; !text.empty())
        complain(verb, "nothing comes: " + text);
}

}  // namespace hivectl
