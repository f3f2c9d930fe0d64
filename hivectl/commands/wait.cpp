// hivectl wait: returns when a drone is in a state.
#include "../verbs.hpp"
#include "run/interrupt.hpp"
#include "words/format.hpp"
#include "words/places.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hivectl::wait_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::vector<std::string> names;
    std::string goal = "running";
};

/// The state of a drone as text: its own, or "gone", or "silent", or "unreachable" on another machine.
std::string state_of(hive::Application& application, const std::string& name)
{
    if (!runs(application, name))
        return "gone";
    const auto answer = application.status(std::vector{name}).at(0);
    if (const auto* status = value_of(answer.status))
        return std::string(token(status->state));
    if (is_elsewhere(answer.place))
        return "unreachable";
    return std::get<hive::Error>(answer.status).code() == hive::Errc::timeout ? "silent" : "gone";
}

bool reached(const std::string& goal, const std::string& state)
{
    return goal == "running" ? state == "idle" || state == "busy" || state == "halted" : state == goal;
}

std::string late_text(const std::string& name, const std::string& goal, const std::string& state,
                      std::chrono::milliseconds limit)
{
    const std::string text = name + " is not " + goal + " after " + duration_text(limit / 1us);
    if (state == "gone")
        return text + "; " + advice_for_missing(name);
    return text + ", but " + printable(state) + (state == "halted" ? "; resume it: hivectl resume " + name : "");
}

int await(const std::string& name, const std::string& goal, Session& session, std::chrono::steady_clock::time_point end,
          Waiting& waiting)
{
    for (;;) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
        session.application().timeout(std::clamp<std::chrono::milliseconds>(left, 1ms, 500ms));
        const std::string state = state_of(session.application(), name);
        if (reached(goal, state))
            return exit_code::done;
        waiting.now_for(name + " to be " + goal + " (now " + state + ")");
        if (std::chrono::steady_clock::now() >= end)
            return fail("wait", hive::Errc::timeout, late_text(name, goal, state, session.timeout(10s)), name);
        interrupt::sleep(std::clamp<std::chrono::milliseconds>(left, 1ms, 20ms));
    }
}

/// A glob stands for the drones that run now; without any, "gone" is reached.
std::vector<std::string> drones_meant(const Options& options, hive::Application& application)
{
    std::vector<std::string> names;
    for (const auto& word : options.names) {
        if (!is_glob(word)) {
            hive::require_name(word.substr(0, word.find('@')), "drone");
            add_new(names, {word});
        } else if (runs(application, word)) {
            add_new(names, application.find(word));
        } else if (options.goal != "gone") {
            throw hive::Error(hive::Errc::not_found, "no running drone matches " + hive::in_quotes(word),
                              "to wait for one that does not run yet, give its name");
        }
    }
    return names;
}

int run(const Options& options, Session& session)
{
    const auto names = drones_meant(options, session.application());
    const auto end = std::chrono::steady_clock::now() + session.timeout(10s);
    Waiting waiting("");
    for (const auto& name : names)
        if (const int code = await(name, options.goal, session, end, waiting); code != exit_code::done)
            return code;
    if (session.json)
        for (const auto& name : names)
            write_out(Row{{"drone", name}, {"reached", options.goal}}.json() + "\n");
    return exit_code::done;
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.names, "drones, running or not yet; a glob stands for those that run now").required();
    line.option("--for", options.goal,
                "running: started and answering (default); idle: nothing to do; halted: taking no events until "
                "resumed; gone: exited")
        .type_name("running|idle|halted|gone")
        .one_of({"running", "idle", "halted", "gone"});
}

}  // namespace

Verb verb()
{
    return {.name = "wait",
            .group = "run drones",
            .usage = "NAME... [--for STATE] [options]",
            .summary = "Waits until drones have reached a state",
            .details = "Exits with 124 at the timeout.",
            .examples = "hivectl wait face\n"
                        "hivectl wait face --for halted --timeout 30",
            .timeout = "give up after this long (default 10)",
            .operands = {Operand::drone},
            .declare = with(declare, run)};
}

}  // namespace hivectl::wait_verb
