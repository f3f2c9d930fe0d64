// hivectl exceptions: shows what went wrong in drones, or changes what they do then.
#include "../command_line.hpp"
#include "../exception_json.hpp"
#include "../exit_code.hpp"
#include "../format.hpp"
#include "../output.hpp"
#include "../printing.hpp"
#include "../session.hpp"
#include "../table.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

namespace hivectl::exceptions_verb {
namespace {

struct Options {
    std::vector<std::string> names;
    bool follow = false;
    std::int64_t count = 0;  // 0: without end
    std::string policy;
};

const std::vector<Column> columns{
    {"DRONE", "drone"}, {"TIME", "time_us", as_time}, {"CODE", "code"}, {"POLICY", "policy"},
    {"INPUT", "input"}, {"SOURCE", "source"},         {"SEQ", "seq"},   {"TEXT", "text"}};

int show_last(const std::vector<std::string>& drones, Session& session, Outcome& outcome)
{
    std::vector<Row> rows;
    for (const auto& answer : session.application().status(drones)) {
        answer.error ? outcome.failed(answer.drone, *answer.error) : outcome.done();
        if (answer.error || !answer.status.last_exception)
            continue;
        Row& row = rows.emplace_back(Row{{"drone", answer.drone}});
        const auto exception = exception_json(*answer.status.last_exception);
        for (const auto& [key, value] : exception.items())
            row.add(key, value);
    }
    print_rows(session.form(), columns, rows);
    return outcome.exit_code();
}

std::string line_of(const hive::Event& event, bool json)
{
    const auto& header = event.header;
    const hive::Fields fields(header, "exception of " + event.sender);
    const Row row{{"drone", event.sender},
                  {"code", fields.text_or("code", "")},
                  {"policy", fields.text_or("policy", "")},
                  {"source", event.identity.source},
                  {"epoch", event.identity.epoch},
                  {"seq", event.identity.sequence},
                  {"header", header}};
    if (json)
        return row.json() + "\n";
    std::string text = printable(event.sender) + " " + printable(row.text("code")) + " ("
                       + printable(row.text("policy")) + "): " + printable(fields.text_or("text", ""));
    if (event.identity.sequence > 0)
        text += " [" + printable(event.identity.source) + " " + std::to_string(event.identity.sequence) + "]";
    return text + "\n";
}

int follow(const std::vector<std::string>& drones, const Options& options, Session& session)
{
    const auto collector = session.application().exceptions(drones);
    return print_lines({.verb = "exceptions", .count = options.count, .patience = session.patience()},
                       [&](auto patience) -> std::optional<std::string> {
                           const auto event = collector->next(patience);
                           return event ? std::optional(line_of(*event, session.json)) : std::nullopt;
                       });
}

int change_policy(const Options& options, const std::vector<std::string>& drones, Session& session, Outcome& outcome)
{
    const auto policy = hive::from_token<hive::ExceptionPolicy>(options.policy, "--on-exception");
    for (const auto& drone : drones) {
        try {
            session.application().exception_policy(drone, policy);
            outcome.done();
            write_out(session.json ? Row{{"drone", drone}, {"on_exception", options.policy}}.json() + "\n"
                                   : drone + " " + options.policy + "\n");
        } catch (const hive::Error& error) {
            outcome.failed(drone, error);
        }
    }
    return outcome.exit_code();
}

int run(const Options& options, Session& session)
{
    if (!options.policy.empty() && options.names.empty())
        throw hive::Error(hive::Errc::invalid_argument, "--on-exception needs the names of the drones",
                          "for all of them: hivectl exceptions '*' --on-exception " + options.policy);
    auto& application = session.application();
    Outcome outcome("exceptions");
    const auto drones =
        options.names.empty() ? application.drones() : drones_named(application, options.names, outcome);
    if (!options.names.empty() && drones.empty())
        return outcome.exit_code();
    if (!options.policy.empty())
        return change_policy(options, drones, session, outcome);
    return options.follow ? outcome.exit_code(follow(drones, options, session)) : show_last(drones, session, outcome);
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("NAME", options->names, "drones or globs (default: all that run)");
    const auto following = line.flag("-f,--follow", options->follow, "print each one as it happens, until Ctrl-C");
    line.option("-n", options->count, "with --follow: end after this many")
        .type_name("N")
        .between(std::int64_t{1}, std::int64_t{1} << 53)
        .needs(following);
    line.option("--on-exception", options->policy,
                "change what the drones do from now on: skip the input and go on, or halt until resumed")
        .type_name("skip|halt")
        .one_of({"skip", "halt"})
        .excludes(following);
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb verb()
{
    return {
        .name = "exceptions",
        .group = "errors",
        .usage = "[NAME...] [--follow | --on-exception skip|halt] [options]",
        .summary = "Shows what went wrong in drones, or changes what they do then",
        .details = "When a drone's code throws, the drone reports an exception. Without options, this shows the last "
                   "one of each drone.",
        .examples = "hivectl exceptions\n"
                    "hivectl exceptions face --follow\n"
                    "hivectl exceptions 'face-*' --on-exception halt",
        .timeout =
            "give up after this long (default 5); with --follow: after this long without an exception (default: never)",
        .table = true,
        .operands = {Operand::drone},
        .declare = declare};
}

}  // namespace hivectl::exceptions_verb
