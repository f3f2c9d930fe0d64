// Converts statuses into samples, one drone after the other, each from one answer.
#include "families.hpp"

#include <hive/stall.hpp>

#include <algorithm>
#include <chrono>

namespace hive {
namespace {

using namespace measuring;

double count(std::int64_t events) { return static_cast<double>(events); }

/// Exceptions are events of this output.
bool is_exceptions(const OutputStatus& output) { return output.name == "exceptions"; }

Labels connection_labels(const std::string& from, const std::string& to, const std::string& group)
{
    const auto [sender, output] = parse_endpoint(from);
    const auto [receiver, input] = parse_endpoint(to);
    return {{"sender", sender}, {"output", output}, {"receiver", receiver}, {"input", input}, {"group", group}};
}

Labels with(Labels labels, const char* name, std::string_view value)
{
    labels.emplace_back(name, value);
    return labels;
}

struct AccountFamilies {
    const Described &came, &settled, &in_flight;
};

void add_account(Book& book, const AccountFamilies& families, const Labels& labels, const Ledger& events,
                 std::int64_t created)
{
    book.add(families.came, labels, count(events.total()), created);
    for (std::size_t fate = 0; fate < fates; ++fate)
        book.add(families.settled, with(labels, "fate", token(static_cast<Fate>(fate))),
                 count(events.of(static_cast<Fate>(fate))), created);
    book.add(families.in_flight, labels, count(events.in_flight()));
}

/// Losses of a sender, as audit() counts them.
std::int64_t lost(const Ledger& events)
{
    std::int64_t sum = 0;
    for (std::size_t fate = 0; fate < fates; ++fate)
        sum += is_loss(static_cast<Fate>(fate)) ? events.of(static_cast<Fate>(fate)) : 0;
    return sum;
}

/// @param peer  the receiver or the group; empty: the drone itself lost them, at an input
void add_lost(Book& book, const std::string& drone, const std::string& port, const std::string& peer,
              const std::string& group, std::int64_t events, std::int64_t created)
{
    book.add(audit_lost, {{"drone", drone}, {"port", port}, {"peer", peer}, {"group", group}}, count(events), created);
}

void add_group(Book& book, const std::string& drone, const OutputStatus& output, const EdgeStatus& group,
               std::int64_t created)
{
    const auto name = group.receiver.substr(group.receiver.find(' ') + 1);  // "group NAME"
    const Labels labels{{"sender", drone}, {"output", output.name}, {"group", name}};
    const auto members = std::ranges::count_if(output.edges, [&](const EdgeStatus& edge) {
        return !edge.group && edge.connected && edge.options.group == name;
    });
    book.add(group_members, labels, count(members));
    add_account(book, {group_came, group_settled, group_in_flight}, labels, group.events, created);
    add_lost(book, drone, output.name, group.receiver, name, lost(group.events), created);
}

void add_edge(Book& book, const std::string& from, const EdgeStatus& edge, std::int64_t created)
{
    const auto labels = connection_labels(from, edge.receiver, edge.options.group);
    book.add(connected, labels, edge.connected ? 1 : 0);
    add_account(book, {came, settled, in_flight}, labels, edge.events, created);
    book.add(waiting, labels, count(edge.waiting));
    book.add(window, labels, edge.options.window);
    book.add(shared, labels, count(edge.shared), created);
    book.add(fallback, labels, count(edge.fallback), created);
    const auto [drone, output] = parse_endpoint(from);
    add_lost(book, drone, output, edge.receiver, edge.options.group, lost(edge.events), created);
}

/// Applications have counters only while they receive, and a new name each time: they are counted, not listed.
bool is_application(const EdgeStatus& edge) { return !edge.group && edge.receiver.find('.') == std::string::npos; }

void add_output(Book& book, const std::string& drone, const Status& status, const OutputStatus& output)
{
    const Labels labels{{"drone", drone}, {"output", output.name}};
    if (is_exceptions(output)) {
        book.add(drone_exceptions, {{"drone", drone}}, count(output.produced), status.epoch);
    } else {
        book.add(emitted, labels, count(output.produced), status.epoch);
        book.add(unreceived, labels, count(output.unreceived), status.epoch);
        book.add(stalled, labels, stalls(status, output) ? 1 : 0);
        if (output.last_emitted_us > 0)
            book.add_us(last_emitted, labels, output.last_emitted_us);
    }
    book.add(applications, labels, count(std::ranges::count_if(output.edges, [](const EdgeStatus& edge) {
                 return edge.connected && is_application(edge);
             })));
    for (const auto& edge : output.edges)
        if (edge.group)
            add_group(book, drone, output, edge, status.epoch);
        else if (!is_application(edge))
            add_edge(book, drone + "." + output.name, edge, status.epoch);
}

void add_input(Book& book, const std::string& drone, const InputStatus& input, std::int64_t created)
{
    const Labels labels{{"drone", drone}, {"input", input.input}};
    book.add(received, labels, count(input.received), created);
    for (const auto& [fate, events] :
         {std::pair{"processed", input.processed}, std::pair{"abandoned", input.abandoned},
          std::pair{"duplicates", input.duplicates}, std::pair{"discarded", input.discarded},
          std::pair{"dropped", input.dropped}, std::pair{"unmatched", input.unmatched}})
        book.add(input_settled, with(labels, "fate", fate), count(events), created);
    book.add(queued, labels, count(input.queued));
    book.add(in_progress, labels, count(input.in_hand));
    add_lost(book, drone, input.input, "", "", input.abandoned + input.dropped, created);
}

void add_distance(Book& book, const std::string& drone, const InputStatus& input)
{
    if (input.from.empty())
        return;  // events that an application put in
    const auto labels = connection_labels(input.from, drone + "." + input.input, input.options.group);
    if (input.received > 0)
        book.add_us(age, labels, input.last_age_us);
    if (input.round_trip_us == 0)
        return;
    book.add_us(round_trip, labels, input.round_trip_us);
    book.add_us(clock_offset, labels, input.clock_offset_us);
}

void add_drone(Book& book, const StatusAnswer& answer)
{
    const auto& status = std::get<Status>(answer.status);
    const Labels labels{{"drone", answer.drone}};
    book.add(drone,
             {{"drone", answer.drone},
              {"host", answer.place.host},
              {"kind", status.kind},
              {"swarm", status.swarm},
              {"version", status.version}},
             1);
    for (const auto each : {State::starting, State::idle, State::busy, State::halted, State::stopping})
        book.add(drone_state, with(labels, drone_state.name, token(each)), each == status.state ? 1 : 0);
    book.add_us(drone_start, labels, status.epoch);
    book.add_us(drone_busy, labels, status.busy_us, status.epoch);
    book.add_us(drone_encoding, labels, status.encoding_us, status.epoch);
    book.add_us(drone_cpu, labels, status.cpu_us, status.epoch);
    book.add(drone_memory, labels, static_cast<double>(status.memory));
    book.add(drone_condition, labels, status.condition.empty() || status.why == Reason::source_ended ? 0 : 1);
    for (const auto& output : status.outputs)
        add_output(book, answer.drone, status, output);
    for (const auto* rows : {&status.inputs, &status.left})
        for (const auto& input : *rows)
            add_input(book, answer.drone, input, status.epoch);
    for (const auto& input : status.inputs)
        add_distance(book, answer.drone, input);
}

}  // namespace

Metrics metrics(const std::vector<StatusAnswer>& answers, const std::vector<std::string>& crashed)
{
    Book book;
    for (const auto& answer : answers)
        book.add(drone_up, {{"drone", answer.drone}, {"host", answer.place.host}}, value_of(answer.status) ? 1 : 0);
    for (const auto& name : crashed)
        book.add(drone_up, {{"drone", name}, {"host", Place::here}}, 0);
    for (const auto& answer : answers)
        if (value_of(answer.status))
            add_drone(book, answer);
    return book.take();
}

Metrics metrics(Application& application)
{
    const auto start = std::chrono::steady_clock::now();
    const auto answers = application.status(application.drones());
    auto families = metrics(answers, application.remembered());
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    Book book;
    book.add(scrape_duration, {}, took.count());
    std::ranges::move(book.take(), std::back_inserter(families));
    return families;
}

}  // namespace hive
