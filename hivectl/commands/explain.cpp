// hivectl explain: shows why nothing arrives, or the rates.
#include "../verbs.hpp"
#include "words/format.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <hive/explain.hpp>

#include <algorithm>

namespace hivectl::explain_verb {
namespace {

using namespace std::chrono_literals;

hive::Explanation explanation_of(const std::vector<std::string>& names, hive::Application& application)
{
    std::vector<hive::Endpoint> ends;
    std::ranges::transform(names, std::back_inserter(ends),
                           [&](const std::string& name) { return application.endpoint(name); });
    return ends.size() == 2 ? hive::explain(application, ends[0], ends[1]) : hive::explain(application, ends);
}

std::string paragraph(const hive::Cause& cause)
{
    const auto line = [](const char* label, const std::string& text) {
        return text.empty() ? "" : std::string("  ") + label + printable(text) + "\n";
    };
    return printable(cause.text) + "\n" + line("evidence: ", cause.evidence) + line("try: ", cause.command);
}

std::string flow_table(const std::vector<hive::Flow>& flows, const Page& page)
{
    std::vector<Row> rows;
    for (const auto& flow : flows)
        rows.push_back(Row{{"name", flow.drone},
                           {"in_per_s", flow.received_per_s},
                           {"out_per_s", flow.emitted_per_s},
                           {"age_us", flow.age_us > 0 ? hive::Json(flow.age_us) : hive::Json()}});
    return table_text({{"NAME", "name"},
                       {"IN/s", "in_per_s", as_tenths},
                       {"OUT/s", "out_per_s", as_tenths},
                       {"AGE", "age_us", as_duration}},
                      rows, page);
}

std::string shown(const hive::Explanation& explanation, const std::vector<std::string>& names, Form form)
{
    std::string blocking, slowing;
    for (const auto& cause : explanation.causes)
        (cause.blocks ? blocking : slowing) += "\n" + paragraph(cause);
    if (!slowing.empty())
        slowing = "\nslower than it could be:" + slowing;
    if (explanation.blocked())
        return blocking.substr(1) + slowing;
    const auto what = names.size() == 2 ? names[0] + " -> " + names[1] : names_text(names);
    return "nothing holds up " + what + "\n" + slowing + (slowing.empty() ? "" : "\n")
           + flow_table(explanation.flows, page_of(form));
}

int run(const std::vector<std::string>& names, Session& session)
{
    if (names.size() > 2)
        throw hive::Error(hive::Errc::invalid_argument, "explain takes one drone, or a sender and a receiver",
                          "for the whole swarm: hivectl explain");
    auto& application = session.application(1s);
    const auto explanation = explanation_of(names, application);
    if (session.json)
        write_out(json_text(to_json(explanation)) + "\n");
    else if (names.empty() && explanation.causes.empty() && explanation.flows.empty())
        complain("explain", "no drones in " + session.home().string() + "; start one: hivectl start KIND");
    else
        write_out(shown(explanation, names, session.form()));
    return explanation.blocked() ? exit_code::found : exit_code::done;
}

void declare(CommandLine& line, std::vector<std::string>& names)
{
    line.option("NAME", names, "a drone or drone.output; or a sender and a receiver (default: all drones)");
}

}  // namespace

Verb verb()
{
    return {
        .name = "explain",
        .group = "errors",
        .usage = "[NAME | SENDER RECEIVER] [options]",
        .summary = "Finds the cause of a stall, with a command that fixes it",
        .details =
            "Follows the events from the named drone back to the sources, and to the drones that these wait for. "
            "Prints what blocks the events, with evidence and a command to try: first the causes, the nearest to the "
            "source on top, then what only slows the events, such as busy processors. If nothing blocks them, prints "
            "the events per second of each drone on the path. Takes two samples, 300 ms apart.\n\n"
            "The exit code is 9 if something blocks the events, and 0 if they flow, even if slowly.\n\n"
            "--json prints one object: text (one line; empty: nothing), flows (drone, received_per_s, emitted_per_s, "
            "age_us), and causes with the keys what, drone, connection, text, evidence, command and blocks (false: it "
            "only slows down). what is one of: not_running, crashed, failed, suspended, no_answer, unreachable, "
            "refused, starting, halted, set_prepared, throws, stuck, source_ended, condition, not_connected, "
            "wrong_way, wrong_types, dialing, held, no_receiver, watched, receiver_away, waits, slow, slow_connection, "
            "small_window, copied, encoder, clock, load, memory, same_name, emits_nothing, silent_source.",
        .examples = "hivectl explain face\n"
                    "hivectl explain camera face --json | jq .flows",
        .timeout = "how long to wait for the answer of a drone (default 1)",
        .table = true,
        .operands = {Operand::sender, Operand::receiver},
        .declare = with(declare, run)};
}

}  // namespace hivectl::explain_verb
