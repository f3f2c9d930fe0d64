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

hive::CommandResult run_there(Session& session, const hive::Place& place, const std::vector<std::string>& words,
                              const std::string& awaited)
{
    const hive::Remote remote(place.ssh, session.home());
    const auto& verb = words.front();
    const auto prefix = remote.host() + ": ", own = "hivectl " + verb + ": ";
    std::optional<Waiting> waiting(awaited + " on " + remote.host());
    auto result = remote.hivectl(words, session.timeout() + 12s);
    waiting.reset();
    std::istringstream lines(result.err);
    for (std::string line; std::getline(lines, line);)
        if (const auto failure = hive::failure_in(line))
            complain_about(verb, failure->reworded(prefix + failure->what()));
        else
            complain(verb, prefix + printable(line.starts_with(own) ? line.substr(own.size()) : line));
    return result;
}

}  // namespace hivectl
