// hivectl graph: prints the graph of the swarm.
#include "../verbs.hpp"
#include "run/drawing.hpp"

#include <hive/graph.hpp>

namespace hivectl::graph_verb {
namespace {

using namespace std::chrono_literals;

int run(const std::string& form, Session& session)
{
    auto& application = session.application(1s);
    const auto graph = hive::graph(application);
    if (session.json || form == "json")
        write_out(json_text(to_json(graph)) + "\n");
    else if (form == "dot")
        write_out(to_dot(graph));
    else if (form == "svg")
        write_out(svg_of(to_dot(graph)));
    else if (graph.drones.empty())
        complain("graph", "no drones in " + session.home().string() + "; start one: hivectl start KIND");
    else
        write_out(to_text(graph));
    return exit_code::done;
}

void declare(CommandLine& line, std::string& form)
{
    line.option("--as", form, "text (default), dot (for Graphviz), svg (drawn by Graphviz) or json")
        .type_name("FORM")
        .one_of({"text", "dot", "svg", "json"});
}

}  // namespace

Verb verb()
{
    return {.name = "graph",
            .group = "connections",
            .usage = "[--as text|dot|svg|json] [options]",
            .summary = "Shows the machines, drones and connections of the swarm",
            .details =
                "Lists each drone under its machine (local: this one), with its kind, state and receivers. In "
                "dot and svg, machines are frames, applications are dashed, and lost connections are dotted. "
                "A drone that crashed stays, and a receiver that is gone too, if its sender waits for it or has lost "
                "events for it. svg needs the package graphviz. json has drones (name, host, kind, state) and "
                "connections (from, to, group, connected); host is empty for an application.",
            .examples = "hivectl graph\n"
                        "hivectl graph --as dot > swarm.dot",
            .timeout = "show a drone as silent if it has not answered by then (default 1)",
            .operands = {},
            .declare = with(declare, run)};
}

}  // namespace hivectl::graph_verb
