// hivectl describe: shows a drone's inputs, outputs and parameters.
#include "../verbs.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

namespace hivectl::describe_verb {
namespace {

std::vector<Row> port_rows(const std::vector<hive::Port>& ports)
{
    std::vector<Row> rows;
    for (const auto& port : ports)
        rows.push_back({{"name", port.name},
                        {"type", port.type},
                        {"encodings", hive::in_words(port.encodings)},
                        {"help", port.help}});
    return rows;
}

std::vector<Row> parameter_rows(const hive::Interface& interface, const hive::Json& values)
{
    std::vector<Row> rows;
    for (const auto& parameter : interface.parameters)
        rows.push_back({{"name", parameter.name},
                        {"value", bare(values.value(parameter.name, hive::Json()))},
                        {"default", bare(parameter.default_value)},
                        {"type", std::string(token(parameter.type))},
                        {"range", hive::range_text(parameter)},
                        {"unit", parameter.unit},
                        {"set_by", parameter.for_operator ? "operator" : ""},
                        {"help", parameter.help}});
    return rows;
}

std::string section(std::string_view title, const std::string& table)
{
    return "\n" + std::string(title) + (table.empty() ? ": none\n" : ":\n" + table);
}

std::string text_of(const std::string& name, const hive::Interface& interface, const hive::Json& values,
                    const Page& page)
{
    const std::vector<Column> ports{
        {"NAME", "name"}, {"TYPE", "type"}, {"ENCODINGS", "encodings", nullptr, nothing}, {"HELP", "help"}};
    const std::vector<Column> parameters{{"NAME", "name"},
                                         {"VALUE", "value"},
                                         {"DEFAULT", "default"},
                                         {"TYPE", "type"},
                                         {"RANGE", "range"},
                                         {"UNIT", "unit"},
                                         {"SET BY", "set_by", nullptr, nothing},
                                         {"HELP", "help"}};
    return name + ": " + printable(interface.kind) + " " + printable(interface.version)
           + (interface.stateful ? ", keeps state between events" : "") + "\n" + printable(interface.summary) + "\n"
           + section("inputs", table_text(ports, port_rows(interface.inputs), page))
           + section("outputs", table_text(ports, port_rows(interface.outputs), page))
           + section("parameters", table_text(parameters, parameter_rows(interface, values), page));
}

std::string json_of(const std::string& name, const hive::Interface& interface, const hive::Json& values)
{
    auto object = hive::to_json(interface);
    object["name"] = name;
    object["values"] = values;
    return json_text(object) + "\n";
}

int run(const std::vector<std::string>& words, Session& session)
{
    auto& application = session.application();
    Outcome outcome("describe");
    std::string gap;
    for (const auto& name : drones_named(application, words, outcome))
        outcome.request(name, [&] {
            const Waiting waiting(name + " to answer");
            const auto interface = application.describe(name);
            const auto values = application.get(name);
            write_out(session.json ? json_of(name, interface, values)
                                   : gap + text_of(name, interface, values, page_of(session.form())));
            gap = "\n";
        });
    return outcome.exit_code();
}

void declare(CommandLine& line, std::vector<std::string>& names)
{
    line.option("NAME", names, "drones or globs").required();
}

}  // namespace

Verb verb()
{
    return {.name = "describe",
            .group = "run drones",
            .usage = "NAME... [options]",
            .summary = "Shows the inputs, outputs and parameters of a drone",
            .details = "Inputs and outputs are shown with their media types; parameters with their current value, "
                       "default, type, range and unit. With --json, one object per drone.",
            .examples = "hivectl describe face\n"
                        "hivectl describe face --json | jq .parameters",
            .table = true,
            .operands = {Operand::drone},
            .declare = with(declare, run)};
}

}  // namespace hivectl::describe_verb
