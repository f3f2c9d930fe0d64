// Runs verbs with the hivectl of another machine.
#include "run/remote_verb.hpp"

#include "words/exit_code.hpp"
#include "words/output.hpp"
#include "run/session.hpp"
#include "words/status_line.hpp"

#include <hive/failure.hpp>
#include <hive/remote.hpp>

#include <sstream>

namespace hivectl {

using namespace std::chrono_literals;

int stop_remotely(Session& session, const hive::Place& place)
{
    const hive::Remote remote(place.ssh, session.home());
    const Waiting waiting(place.drone + " to exit on " + remote.host());
    const auto result = remote.hivectl({"stop", place.drone}, session.timeout() + 12s);
    relay_errors("stop", remote.host(), result.err);
    if (result.exit_code == exit_code::done || result.exit_code == exit_code::not_found)
        session.application().forget_place(place);
    return result.exit_code;
}

void relay_errors(std::string_view verb, const std::string& host, const std::string& text)
{
    const std::string own = "hivectl " + std::string(verb) + ": ";
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (const auto failure = hive::failure_in(line))
            complain_about(verb, failure->reworded(host + ": " + failure->what()));
        else
            complain(verb, host + ": " + printable(line.starts_with(own) ? line.substr(own.size()) : line));
}

}  // namespace hivectl
