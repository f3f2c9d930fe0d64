#include "run/silence.hpp"

#include "words/output.hpp"

namespace hivectl {

using namespace std::chrono_literals;

hive::Explanation explain_silence(hive::Application& application, const std::vector<hive::Endpoint>& outputs)
{
    application.timeout(500ms);
    return hive::explain(application, outputs);
}

std::string silence_reason(hive::Application& application, const std::vector<hive::Endpoint>& outputs)
{
    const auto text = to_text(explain_silence(application, outputs));
    return text.empty() ? "see what is connected: hivectl connections" : text;
}

void report_silence(const std::string& verb, hive::Application& application, const std::vector<hive::Endpoint>& outputs)
{
    if (const auto text = to_text(explain_silence(application, outputs)); !text.empty())
        complain(verb, "no events: " + text);
}

}  // namespace hivectl
