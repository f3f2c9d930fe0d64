// hivectl down: stops the drones that a swarm brought up.
#include "../verbs.hpp"
#include "run/interrupt.hpp"
#include "run/swarm_file.hpp"
#include "run/swarm_work.hpp"

#include <hive/swarm.hpp>

namespace hivectl::down_verb {
namespace {

using namespace std::chrono_literals;

/// @param code  what is returned if some of the swarms cannot be stopped
std::vector<hive::SwarmPlan> plans_meant(const SwarmInput& input, hive::Application& application, int& code)
{
    if (input.file.empty())
        return hive::Swarm::remembered(application, [&](const hive::Error& error) {
            complain_about("down", error);
            code = exit_code::partly_done;
        });
    if (auto plan = read_plan("down", input))
        return {*std::move(plan)};
    return {};
}

int run(const SwarmInput& input, Session& session)
{
    auto& application = session.application();
    int code = exit_code::done;
    const auto plans = plans_meant(input, application, code);
    if (plans.empty() && !input.file.empty())
        return exit_code::refused;
    if (plans.empty() && code == exit_code::done)
        complain("down", "no swarm was brought up here");
    for (const auto& plan : plans) {
        if (interrupt::requested()) {
            complain("down", plan.name + " was left as it is");
            code = interrupt::exit_code();
            continue;
        }
        const auto outcome = [&] {
            const SwarmWork work("down");
            return hive::Swarm(application, plan).down(session.timeout(10s), work.watch());
        }();
        for (const auto& step : outcome.steps)
            write_out(session.json ? Row{{"stopped", step.drone}}.json() + "\n" : step.drone + "\n");
        if (const int worse = complain_about("down", outcome); worse != exit_code::done)
            code = worse;
    }
    return code;
}

void declare(CommandLine& line, SwarmInput& input)
{
    line.option("FILE", input.file, "the swarm file (default: every swarm that was brought up from here)");
    declare_variables(line, input);
}

}  // namespace

Verb verb()
{
    return {.name = "down",
            .group = "a swarm from a file",
            .usage = "[FILE] [options]",
            .summary = "Stops the drones of a swarm",
            .details = "Prints the names of the stopped drones. Drones that another swarm or a user started are left "
                       "alone and listed on stderr. Sources stop first; each drone exits once its events are "
                       "delivered, so a lossless event is lost only if its receiver does not take it in time. Ctrl-C "
                       "ends the wait, and skips the remaining swarms.",
            .examples = "hivectl down\n"
                        "hivectl down doorway.json",
            .timeout = "wait for events in flight, then drop them (default 10)",
            .operands = {Operand::file},
            .declare = with(declare, run)};
}

}  // namespace hivectl::down_verb
