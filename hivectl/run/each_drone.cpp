// Runs one action on each of some drones, and derives the exit code.
#include "run/each_drone.hpp"

#include "run/command_line.hpp"
#include "words/exit_code.hpp"
#include "words/output.hpp"
#include "run/session.hpp"
#include "words/status_line.hpp"
#include "words/table.hpp"
#include "words/targets.hpp"

namespace hivectl {

Run for_each_drone(CommandLine& line, Session& session, std::string_view verb, std::string_view done,
                   void (hive::Application::*action)(const std::string&))
{
    auto names = std::make_shared<std::vector<std::string>>();
    line.option("NAME", *names, "drones, or globs such as 'face-*'").required();
    return [names, &session, verb, done, action] {
        auto& application = session.application();
        Outcome outcome(verb);
        for (const auto& name : drones_named(application, *names, outcome)) {
            try {
                const Waiting waiting(name + " to answer");
                (application.*action)(name);
                outcome.done();
                write_out(session.json ? Row{{std::string(done), name}}.json() + "\n" : name + "\n");
            } catch (const hive::Error& error) {
                outcome.failed(name, error);
            }
        }
        return outcome.exit_code();
    };
}

}  // namespace hivectl
