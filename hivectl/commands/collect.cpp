// hivectl collect: prints sets of matching events, one JSON object per line.
#include "../verbs.hpp"
#include "run/event_row.hpp"
#include "run/printing.hpp"
#include "run/silence.hpp"
#include "words/format.hpp"
#include "words/losses.hpp"
#include "words/progress.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <algorithm>
#include <optional>

namespace hivectl::collect_verb {
namespace {

struct Options {
    std::vector<std::string> names;
    std::int64_t count = 0;  // 0: unlimited
    std::optional<int> within_ms;
    bool notify = false, stay = false;
};

hive::Match rule(const Options& options)
{
    return options.within_ms ? hive::Match::within(std::chrono::milliseconds(*options.within_ms))
                             : hive::Match::exact();
}

/// The time between the first and last capture of a set.
double spread_ms(const std::vector<hive::Event>& set)
{
    const auto captured = [](const hive::Event& event) { return event.identity.captured_us; };
    const auto [first, last] = std::ranges::minmax_element(set, {}, captured);
    return static_cast<double>(captured(*last) - captured(*first)) / 1000;
}

std::string line_of(const std::vector<hive::Event>& set)
{
    const auto& identity = set.front().identity;
    std::string text = Row{
        {"source", identity.source},
        {"epoch", identity.epoch},
        {"seq", identity.sequence},
        {"spread_ms",
         spread_ms(set)}}.json();
    text.pop_back();  // the brace: the events follow in the format of `results`
    std::vector<Row> events;
    std::ranges::transform(set, std::back_inserter(events), event_row);
    return text + ",\"events\":" + json_array(events) + "}\n";
}

void summarize(const hive::MatchedCollector& collector, const std::vector<Loss>& losses)
{
    const auto counts = collector.counts();
    std::string text;
    for (const auto& [output, count] : counts.missing)
        text += ", " + std::to_string(count) + " without " + output;
    if (counts.duplicates > 0)
        text += ", " + std::to_string(counts.duplicates) + " came twice";
    if (const auto dropped = collector.received().dropped; dropped > 0)
        text += ", " + std::to_string(dropped) + " dropped by hivectl, which could not keep up";
    if (!text.empty())
        complain("collect", count_text(counts.sets, "set") + printable(text));
    for (const auto& loss : losses)
        if (loss.promised)
            complain("collect", "lost: " + printable(sentence(loss)));
}

int run(const Options& options, Session& session)
{
    auto& application = session.application();
    Outcome outcome("collect");
    const auto outputs = outputs_named(application, options.names, "application/json", outcome);
    if (outcome.exit_code() != exit_code::done)
        return outcome.exit_code();  // a set needs all of them
    hive::CollectOptions collecting;
    collecting.connection.delivery = options.notify ? hive::Delivery::notification : hive::Delivery::data;
    const auto collector = application.collect_matched(outputs, rule(options), collecting);
    std::optional<Progress> progress(std::in_place, application, true);
    const int code = print_lines({.verb = "collect",
                                  .count = options.count,
                                  .timeout = session.given_timeout(),
                                  .reason = [&] { return silence_reason(application, outputs); },
                                  .ended = [&] { return options.stay ? std::nullopt : collector->ended(); },
                                  .what = names_text(texts_of(outputs)),
                                  .silence = [&] { report_silence("collect", application, outputs); }},
                                 [&](auto timeout) -> std::optional<std::string> {
                                     const auto set = collector->next(timeout);
                                     if (set && set->front().identity.lossless)
                                         progress->note(set->front().identity);
                                     return set ? std::optional(line_of(*set)) : std::nullopt;
                                 });
    progress.reset();
    summarize(*collector, losses_now(application, collector->inputs()));
    return code;
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.names, "two or more drones, drone.output or globs; omit the output if only one is JSON")
        .required();
    line.option("-n", options.count, "end after this many sets").count();
    line.option("--within", options.within_ms,
                "match the nearest captures, at most this far apart (default: only events of the same capture)")
        .type_name("MS")
        .milliseconds(0, 3'600'000);
    line.flag("--notify", options.notify, "receive headers only, so drones need not make bodies");
    line.flag("--stay", options.stay, "keep waiting after every source has ended");
}

}  // namespace

Verb verb()
{
    return {.name = "collect",
            .group = "results",
            .usage = "NAME[.OUTPUT] NAME[.OUTPUT]... [-n N] [options]",
            .summary = "Prints matching results of several drones, one JSON object per line",
            .details = "Each line is a set with one event of each output, in the order of the arguments: source, epoch "
                       "and seq of the first event, spread_ms (time between the captures) and events, each as hivectl "
                       "results prints it. Ends when every source has ended. Unmatched events are left out; the last "
                       "lines on stderr count them by the output that had no match, and list losses.",
            .examples = "hivectl collect camera.image face.faces -n 5\n"
                        "hivectl collect left right --within 20 -n 5 | jq .spread_ms",
            .timeout = "give up after this long without a set (default: never)",
            .operands = {Operand::sender},
            .declare = with(declare, run)};
}

}  // namespace hivectl::collect_verb
