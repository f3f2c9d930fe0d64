// hivectl exceptions: shows drones' exceptions, or sets their exception policy.
#include "../verbs.hpp"
#include "run/exception_json.hpp"
#include "run/kept_inputs.hpp"
#include "run/printing.hpp"
#include "words/format.hpp"
#include "words/targets.hpp"

#include <algorithm>

namespace hivectl::exceptions_verb {
namespace {

struct Options {
    std::vector<std::string> names;
    bool follow = false;
    std::int64_t count = 0;  // 0: unlimited
    std::string policy;
    std::string save;
};

const std::vector<Column> columns{{"DRONE", "drone"},
                                  {"NO", "number", nullptr, nothing},
                                  {"TIME", "time_us", as_time},
                                  {"CODE", "code"},
                                  {"POLICY", "policy", nullptr, nothing},
                                  {"INPUT", "input"},
                                  {"SOURCE", "source"},
                                  {"SEQ", "seq"},
                                  {"KEPT", "kept", as_size, nothing},
                                  {"TEXT", "text"}};

/// The failures of running drones, and of those that left some.
std::vector<std::string> drones_meant(const Options& options, hive::Application& application, Outcome& outcome)
{
    auto left = application.failing();
    if (options.names.empty()) {
        auto drones = application.drones();
        add_new(drones, std::move(left));
        return drones;
    }
    std::vector<std::string> drones;
    for (const auto& word : options.names)
        if (std::ranges::find(left, word) != left.end() && !runs(application, word))
            add_new(drones, {word});
        else
            add_new(drones, drones_named(application, {word}, outcome));
    return drones;
}

/// The last exception of each drone, unless its input is kept.
void add_last(const std::vector<std::string>& drones, Session& session, std::vector<Row>& rows, Outcome& outcome)
{
    for (const auto& answer : session.application().status(drones)) {
        const auto* error = error_of(answer.status);
        const auto* status = value_of(answer.status);
        error ? outcome.failed(answer.drone, *error) : outcome.done();
        if (!status || !status->last_exception)
            continue;
        Row row{{"drone", answer.drone}};
        const auto exception = exception_json(*status->last_exception);
        for (const auto& [key, value] : exception.items())
            row.add(key, value);
        const auto kept = std::ranges::find_if(rows, [&](const Row& other) {
            return std::ranges::all_of(std::initializer_list<const char*>{"drone", "source", "seq", "code", "text"},
                                       [&](const char* key) { return other[key] == row[key]; });
        });
        if (kept == rows.end())
            rows.push_back(std::move(row));
        else
            kept->add("policy", row["policy"]);
    }
}

int show_last(const std::vector<std::string>& drones, Session& session, Outcome& outcome)
{
    auto& application = session.application();
    std::vector<Row> rows;
    for (const auto& drone : drones)
        for (const auto& failure : application.failures(drone))
            rows.push_back(failure_row(failure));
    auto running = drones;
    const auto all = application.drones();
    const auto ended = std::erase_if(running, [&](const auto& drone) {
        return !std::ranges::binary_search(all, drone) && drone.find('@') == std::string::npos;
    });
    if (ended > 0)
        outcome.done();
    add_last(running, session, rows, outcome);
    std::ranges::stable_sort(rows, {},
                             [](const Row& row) { return std::pair(row.text("drone"), row.number("time_us")); });
    print_rows(session.form(), columns, rows);
    return outcome.exit_code();
}

int save(const std::vector<std::string>& drones, const Options& options, Session& session, Outcome& outcome)
{
    bool any = false;
    for (const auto& drone : drones)
        for (const auto& failure : session.application().failures(drone, true))
            outcome.request(drone, [&] {
                any = true;
                const auto files = save_failure(session.application(), failure, options.save);
                auto row = failure_row(failure);
                write_out(session.json ? row.add("files", files).json() + "\n" : "");
                for (const auto& file : session.json ? std::vector<std::string>() : files)
                    write_out(printable((std::filesystem::path(options.save) / file).string()) + "\n");
            });
    if (!any)
        throw hive::Error(hive::Errc::not_found, "no input is kept on this machine of a drone that failed",
                          "see what went wrong: hivectl exceptions");
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
    return print_lines({.verb = "exceptions", .count = options.count, .timeout = session.given_timeout()},
                       [&](auto timeout) -> std::optional<std::string> {
                           const auto event = collector->next(timeout);
                           return event ? std::optional(line_of(*event, session.json)) : std::nullopt;
                       });
}

int change_policy(const Options& options, const std::vector<std::string>& drones, Session& session, Outcome& outcome)
{
    const auto policy = hive::from_token<hive::ExceptionPolicy>(options.policy, "--on-exception");
    for (const auto& drone : drones) {
        outcome.request(drone, [&] {
            session.application().exception_policy(drone, policy);
            write_out(session.json ? Row{{"drone", drone}, {"on_exception", options.policy}}.json() + "\n"
                                   : drone + " " + options.policy + "\n");
        });
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
    const auto drones = drones_meant(options, application, outcome);
    if (!options.names.empty() && drones.empty())
        return outcome.exit_code();
    if (!options.policy.empty())
        return change_policy(options, drones, session, outcome);
    if (!options.save.empty())
        return save(drones, options, session, outcome);
    return options.follow ? outcome.exit_code(follow(drones, options, session)) : show_last(drones, session, outcome);
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.names, "drones or globs (default: all that run)");
    const auto following = line.flag("-f,--follow", options.follow, "print exceptions as they happen, until Ctrl-C");
    line.option("-n", options.count, "with --follow: exit after this many").count().needs(following);
    const auto saving = line.option("--save", options.save,
                                    "write each kept input to this directory: NAME-NO.INPUT.jpg (.png, .txt, .bin), "
                                    "with a .json with its header and the failure; and NAME-NO.failure, the whole "
                                    "failure, for hivectl rerun; overwrites nothing")
                            .type_name("DIR")
                            .excludes(following);
    line.option("--on-exception", options.policy,
                "set the exception policy: skip the input and continue, or halt until resumed")
        .type_name("skip|halt")
        .one_of({"skip", "halt"})
        .excludes(following)
        .excludes(saving);
}

}  // namespace

Verb verb()
{
    return {
        .name = "exceptions",
        .group = "errors",
        .usage = "[NAME...] [--follow | --save DIR | --on-exception skip|halt] [options]",
        .summary = "Shows drones' exceptions, or sets their exception policy",
        .details = "A drone whose code throws reports an exception. Without options, shows the last one of each drone, "
                   "and each failure whose input is kept, crashes included, with its number (NO). A drone keeps the "
                   "input that its code threw at; a sender keeps the events that a receiver was processing when it "
                   "crashed, was disconnected, or exceeded its lease. Each machine keeps the last 4 failures of a "
                   "drone, and 64 MiB in all. A crash counts as a failure at the first unfinished event of each "
                   "sender. `hivectl rerun` reruns a kept input in a new drone.",
        .examples = "hivectl exceptions\n"
                    "hivectl exceptions face --follow\n"
                    "hivectl exceptions face --save broken\n"
                    "hivectl exceptions 'face-*' --on-exception halt",
        .timeout =
            "give up after this long (default 5); with --follow: after this long without an exception (default: never)",
        .table = true,
        .operands = {Operand::drone},
        .declare = with(declare, run)};
}

}  // namespace hivectl::exceptions_verb
