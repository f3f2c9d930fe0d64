// hivectl connect: sends the events of an output to inputs.
#include "../verbs.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <hive/connection_option.hpp>

#include <map>

namespace hivectl::connect_verb {
namespace {

struct Options {
    std::string sender;
    std::vector<std::string> receivers;
    bool share = false;
    std::map<std::string_view, bool> flags;  ///< by name of the option
    std::map<std::string_view, std::string> values;
};

hive::ConnectionOptions connection_of(const Options& options, const std::string& sender)
{
    hive::ConnectionOptions connection;
    for (const auto& option : hive::connection_option_table()) {
        const auto value = options.values.find(option.name);
        const bool is_set = option.is_flag() ? option.set(connection, options.flags.at(option.name))
                                             : value->second.empty() || option.set_text(connection, value->second);
        if (!is_set)
            throw hive::Error(hive::Errc::invalid_argument, option.on_command_line() + " must be "
                                                                + std::string(option.must) + ", not "
                                                                + hive::in_quotes(value->second));
    }
    if (connection.group.empty() && options.share)
        connection.group = sender;
    if (connection.lease && connection.group.empty())
        throw hive::Error(hive::Errc::invalid_argument, "--lease" + std::string(hive::for_shared_work),
                          "add --share or --group NAME");
    return connection;
}

void report(const hive::Endpoint& from, const hive::Endpoint& to, const hive::ConnectionOptions& connection, bool json)
{
    write_out(json ? Row{{"from", to_text(from)}, {"to", to_text(to)}, {"options", hive::to_json(connection)}}.json()
                         + "\n"
                   : to_text(from) + " -> " + to_text(to) + "\n");
}

int run(const Options& options, Session& session)
{
    auto& application = session.application();
    const auto sender = application.endpoint(options.sender);
    application.find(sender.drone);  // one error about the sender, instead of one per receiver
    const auto connection = connection_of(options, sender.drone);
    Outcome outcome("connect");
    const auto receivers = endpoints_named(application, options.receivers, outcome);
    std::vector<hive::SwarmConnection> connections;
    for (const auto& receiver : receivers)
        connections.push_back({sender, receiver, connection});
    const Waiting waiting(
        (receivers.size() == 1 ? to_text(receivers.front()) : std::to_string(receivers.size()) + " receivers")
        + " to connect");
    const auto answers = application.connect(connections);
    for (std::size_t i = 0; i < receivers.size(); ++i)
        if (const auto& [from, to, error] = answers[i]; error) {
            outcome.failed(to_text(receivers[i]), *error);
        } else {
            report(from, to, connection, session.json);
            outcome.done();
        }
    return outcome.exit_code();
}

Option declare(CommandLine& line, const hive::ConnectionOption& option, Options& options)
{
    const auto name = option.on_command_line();
    const std::string help(option.help);
    if (option.is_flag())
        return line.flag(name, options.flags[option.name], help);
    const auto declared =
        line.option(name, options.values[option.name], help).type_name(std::string(option.placeholder));
    using Type = hive::ConnectionOption::Type;
    return option.type == Type::count      ? declared.between(1, hive::widest_window)
           : option.type == Type::duration ? declared.seconds(hive::shortest_lease_s, hive::longest_lease_s)
           : option.type == Type::encoding ? declared.encoding()
                                           : declared;
}

void declare(CommandLine& line, Options& options)
{
    line.option("SENDER", options.sender, "drone or drone.output; omit the output if only one fits").required();
    line.option("RECEIVER", options.receivers, "drones or drone.input, one or several; globs such as 'face-*'")
        .required();
    std::map<std::string_view, Option> declared;
    declared.emplace("share", line.flag("--share", options.share,
                                        "share the work: each event goes to one receiver, the one with the fewest "
                                        "events in progress that has waited longest"));
    for (const auto& option : hive::connection_option_table())
        declared.emplace(option.name, declare(line, option, options));
    for (const auto& [one, other] : hive::connection_clashes())
        declared.at(other).excludes(declared.at(one));
}

}  // namespace

Verb verb()
{
    return {.name = "connect",
            .group = "connections",
            .usage = "SENDER[.OUTPUT] RECEIVER[.INPUT]... [options]",
            .summary = "Sends the events of one drone to others",
            .details = "Returns once both ends have confirmed the connection, and prints the connected ports. By "
                       "default a receiver gets the newest event each time it is ready, so it never falls behind. When "
                       "an end restarts, the connection is restored.",
            .examples = "hivectl connect camera face\n"
                        "hivectl connect camera.image face.image --window 2\n"
                        "hivectl connect camera face --encoding jpeg:60\n"
                        "hivectl connect camera 'face-*' --share  divide the work",
            .operands = {Operand::sender, Operand::receiver},
            .declare = with(declare, run)};
}

}  // namespace hivectl::connect_verb
