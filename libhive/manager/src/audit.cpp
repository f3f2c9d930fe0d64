// Compares the counts of both ends where they must agree even with events in flight.
#include <hive/audit.hpp>

#include <algorithm>
#include <array>

namespace hive {
namespace {

struct Looks {
    const std::vector<StatusAnswer>&first, &second, &third;
};

/// One end of a connection in the three answers of a drone. The first is null if there was none of this run.
using Answers = std::array<const Status*, 3>;

/// Nothing if the drone did not answer in the second or third look, or was restarted between them.
std::optional<Answers> answers_of(const Looks& looks, const std::string& drone)
{
    const auto answer_in = [&](const std::vector<StatusAnswer>& look) {
        const auto found = std::ranges::find(look, drone, &StatusAnswer::drone);
        return found == look.end() ? nullptr : value_of(found->status);
    };
    Answers answers{answer_in(looks.first), answer_in(looks.second), answer_in(looks.third)};
    if (!answers[1] || !answers[2] || answers[1]->epoch != answers[2]->epoch)
        return std::nullopt;
    if (answers[0] && answers[0]->epoch != answers[1]->epoch)
        answers[0] = nullptr;
    return answers;
}

/// What a row of closed connections has as its sender: an input keeps only their sum.
const std::string closed = "closed connections";

/// All edges of an output for one receiver: plain and in each group, since a receiver counts these together.
struct Sent {
    std::int64_t acknowledged = 0, sent = 0;
    bool known = false;      ///< there is such an edge
    int plain = 0;           ///< edges that are not in a group
    bool connected = false;  ///< with the given registration
};

Sent sent_to(const Status& sender, const ConnectionEnds& ends, std::int64_t registration)
{
    Sent sum;
    for (const auto& output : sender.outputs)
        for (const auto& edge : output.edges) {
            if (edge.group || edge.receiver != ends.to || !ends.from.ends_with("." + output.name))
                continue;
            sum.acknowledged += edge.events.of(Fate::acknowledged);
            sum.sent +=
                edge.events.total() - edge.waiting - edge.events.of(Fate::skipped) - edge.events.of(Fate::dropped);
            sum.known = true;
            sum.plain += edge.options.group.empty() ? 1 : 0;
            sum.connected = sum.connected || (edge.connected && edge.registration == registration);
        }
    return sum;
}

const InputStatus* input_of(const Status& receiver, const ConnectionEnds& ends)
{
    const auto found = std::ranges::find_if(receiver.inputs, [&](const InputStatus& input) {
        return input.from == ends.from && ends.to.ends_with("." + input.input);
    });
    return found == receiver.inputs.end() ? nullptr : &*found;
}

std::int64_t dealt_with(const InputStatus& input) { return input.received - input.queued - input.in_hand; }

/// With connections of this input that have ended.
std::int64_t dealt_with(const Status& receiver, const InputStatus& input)
{
    std::int64_t sum = dealt_with(input);
    for (const auto& row : receiver.left)
        if (row.input == input.input)
            sum += dealt_with(row);
    return sum;
}

bool balances(const InputStatus& input)
{
    return input.received
           == input.processed + input.abandoned + input.duplicates + input.discarded + input.dropped + input.unmatched
                  + input.queued + input.in_hand;
}

/// Which end started first, by the sender's clock; nothing if the clocks of two machines were not compared.
struct StartOrder {
    bool sender_first = false, receiver_first = false;
};

StartOrder started(const Status& sender, const Status& receiver, const ConnectionEnds& ends, const InputStatus& input)
{
    constexpr std::int64_t margin_us = 1'000'000;
    const bool one_clock = ends.from_host == ends.to_host;
    if (!one_clock && input.round_trip_us == 0)
        return {};
    const auto by_sender_clock = receiver.epoch + (one_clock ? 0 : input.clock_offset_us);
    const auto margin = one_clock ? 0 : margin_us;
    return {.sender_first = sender.epoch + margin < by_sender_clock,
            .receiver_first = by_sender_clock + margin < sender.epoch};
}

/// Compares what one end counts in the second look with the counts of the other end in the third, which come later. An
/// end has counted all of the other end's events only if it started first.
void compare_counts(AuditRow& row, const Answers& sender, const Answers& receiver)
{
    const auto *earlier = input_of(*receiver[1], row.ends), *later = input_of(*receiver[2], row.ends);
    if (!earlier || !later)
        return;
    const auto before = sent_to(*sender[1], row.ends, earlier->registration),
               after = sent_to(*sender[2], row.ends, later->registration);
    const auto first = started(*sender[1], *receiver[1], row.ends, *earlier);
    const auto known = dealt_with(*receiver[2], *later), worked = earlier->processed + earlier->unmatched;
    if (first.receiver_first && before.plain <= 1 && before.acknowledged > known)
        row.differences.push_back("the sender counts " + std::to_string(before.acknowledged)
                                  + " acknowledged events, and the receiver reports " + std::to_string(known));
    if (first.sender_first && after.known && worked > after.sent)
        row.differences.push_back("the receiver has processed " + std::to_string(worked)
                                  + " events, of which the sender has sent " + std::to_string(after.sent));
}

/// Only differences in all three looks count: a connection may be opened or closed meanwhile.
void compare_states(AuditRow& row, const Answers& sender, const Answers& receiver)
{
    if (!sender[0] || !receiver[0])
        return;
    bool missing = true, unknown = true;
    for (std::size_t i = 0; i < sender.size(); ++i) {
        const auto* input = input_of(*receiver[i], row.ends);
        const auto registration = input                ? input->registration
                                  : row.ends.at_sender ? row.ends.at_sender->registration
                                                       : 0;
        const bool connected = sent_to(*sender[i], row.ends, registration).connected;
        missing = missing && connected && (!input || !input->connected);
        unknown = unknown && !connected && input && input->connected;
    }
    if (missing)
        row.differences.emplace_back("the sender has it registered, and the receiver is not connected");
    if (unknown)
        row.differences.emplace_back("the receiver is connected, and the sender has no such registration");
}

void check_ends(AuditRow& row)
{
    if (const auto& edge = row.ends.at_sender; edge && (edge->events.in_flight() < edge->waiting || edge->waiting < 0))
        row.differences.push_back("the sender counts more events than it offered: "
                                  + std::to_string(edge->events.total()) + " came, "
                                  + std::to_string(edge->events.in_flight()) + " are left over");
    if (const auto& input = row.ends.at_receiver; input && !balances(*input))
        row.differences.push_back("the receiver's counts do not add up to the " + std::to_string(input->received)
                                  + " events that it has received");
}

/// @param at_receiver  null: it does not answer
void add_losses(AuditRow& row, const Status* at_receiver)
{
    std::int64_t last_us = 0;
    const auto add = [&](std::string_view fate, const std::string& at, std::int64_t events, bool promised,
                         const std::string& reason = {}) {
        if (events > 0)
            row.losses.push_back({std::string(fate), at, events, promised, promised ? last_us : 0, reason});
    };
    const auto sender = parse_endpoint(row.ends.from).drone, receiver = parse_endpoint(row.ends.to).drone;
    if (const auto& edge = row.ends.at_sender) {
        last_us = edge->last_lost_us;
        for (const auto fate : {Fate::skipped, Fate::dropped, Fate::abandoned, Fate::lost_connection, Fate::lost_killed,
                                Fate::lost_cut_off, Fate::lost_left})
            add(token(fate), sender, edge->events.of(fate), is_loss(fate));
    }
    if (const auto& input = row.ends.at_receiver) {
        last_us = input->last_lost_us;
        add("dropped", receiver, input->dropped, true);
        const auto* threw = at_receiver && at_receiver->last_exception ? &*at_receiver->last_exception : nullptr;
        add("abandoned", receiver, input->abandoned, true, threw && threw->input == input->input ? threw->text : "");
        add("unmatched", receiver, input->unmatched, false);
        // A member returns discarded events, and a closed connection may have been one of a member.
        if (row.ends.from != closed && row.ends.options().group.empty())
            add("discarded", receiver, input->discarded, false);
    }
}

/// Losses first, then events that the connection or the receiver skipped by choice.
std::string fates_text(const AuditRow& row)
{
    std::string text;
    for (const bool promised : {true, false})
        for (const auto& loss : row.losses)
            if (loss.promised == promised)
                text += (text.empty() ? "" : ", ") + std::to_string(loss.events) + " " + loss.fate + " at " + loss.at
                        + (loss.reason.empty() ? "" : " (last: " + loss.reason + ")");
    return text;
}

std::string state_of(const AuditRow& row)
{
    if (row.ends.is_group())
        return "group";
    if (row.ends.from == closed)
        return "closed";
    if (!row.ends.at_sender)
        return row.sender_answers ? "unknown to the sender" : "sender gone";
    if (!row.ends.at_sender->connected)
        return "receiver gone";
    return row.receiver_answers ? "both ends" : "sender only";
}

/// An input's losses do not end with the connection.
void add_closed(Audit& audit, const std::string& drone, const Status& status)
{
    for (const auto& input : status.left) {
        AuditRow row{.ends = {.from = closed, .to = drone + "." + input.input, .at_receiver = input},
                     .receiver_answers = true};
        check_ends(row);
        add_losses(row, &status);
        if (row.lost() > 0 || !row.differences.empty())
            audit.rows.push_back(std::move(row));
    }
}

}  // namespace

std::int64_t AuditRow::lost() const
{
    std::int64_t sum = 0;
    for (const auto& loss : losses)
        sum += loss.promised ? loss.events : 0;
    return sum;
}

bool Audit::clean() const
{
    return std::ranges::all_of(rows, [](const AuditRow& row) { return row.lost() == 0 && row.differences.empty(); });
}

void Audit::forget_before(std::int64_t time_us)
{
    for (auto& row : rows)
        std::erase_if(row.losses, [&](const AuditLoss& loss) { return loss.last_us != 0 && loss.last_us < time_us; });
}

Audit audit(const std::vector<StatusAnswer>& first, const std::vector<StatusAnswer>& second,
            const std::vector<StatusAnswer>& third)
{
    const Looks looks{first, second, third};
    Audit audit;
    for (auto& ends : connection_ends(third)) {
        AuditRow row{.ends = std::move(ends)};
        const auto sender = answers_of(looks, parse_endpoint(row.ends.from).drone);
        const auto receiver = row.ends.is_group() ? std::nullopt : answers_of(looks, parse_endpoint(row.ends.to).drone);
        row.sender_answers = sender.has_value();
        row.receiver_answers = receiver.has_value();
        check_ends(row);
        add_losses(row, receiver ? (*receiver)[2] : nullptr);
        if (sender && receiver) {
            compare_counts(row, *sender, *receiver);
            compare_states(row, *sender, *receiver);
        }
        audit.rows.push_back(std::move(row));
    }
    for (const auto& answer : third)
        if (const auto* status = value_of(answer.status))
            add_closed(audit, answer.drone, *status);
        else
            audit.silent.push_back(answer.drone);
    return audit;
}

/// Null: none, or not known.
static Json last_loss(const AuditRow& row)
{
    std::int64_t last_us = 0;
    for (const auto& loss : row.losses)
        last_us = std::max(last_us, loss.last_us);
    return last_us == 0 ? Json() : Json(last_us);
}

Json to_json(const AuditRow& row)
{
    const auto& edge = row.ends.at_sender;
    const auto& input = row.ends.at_receiver;
    const auto of = [](bool known, std::int64_t count) { return known ? Json(count) : Json(); };
    const auto events = edge ? edge->events : Ledger();
    Json losses = Json::array();
    for (const auto& loss : row.losses)
        losses.push_back({{"fate", loss.fate},
                          {"at", loss.at},
                          {"events", loss.events},
                          {"promised", loss.promised},
                          {"last_us", loss.last_us},
                          {"reason", loss.reason}});
    Json json{{"from", row.ends.from},
              {"to", row.ends.to},
              {"state", state_of(row)},
              {"came", of(edge.has_value(), events.total())},
              {"in_flight", of(edge.has_value(), events.in_flight())},
              {"received", of(input.has_value(), input ? input->received : 0)},
              {"processed", of(input.has_value(), input ? input->processed : 0)},
              {"lost", row.lost()},
              {"last_lost_us", last_loss(row)},
              {"fates", fates_text(row)},
              {"losses", losses},
              {"differences", row.differences},
              {"verdict", !row.differences.empty() ? "differs"
                          : row.lost() > 0         ? "lost"
                                                   : "ok"}};
    for (std::size_t fate = 0; fate < fates; ++fate)
        json[token(static_cast<Fate>(fate))] = of(edge.has_value(), events.of(static_cast<Fate>(fate)));
    return json;
}

Json to_json(const Audit& audit)
{
    Json rows = Json::array();
    for (const auto& row : audit.rows)
        rows.push_back(to_json(row));
    return {{"clean", audit.clean()}, {"connections", rows}, {"silent", audit.silent}};
}

Audit audit(Application& application)
{
    std::vector<StatusAnswer> last;
    return audit(application, last);
}

Audit audit(Application& application, std::vector<StatusAnswer>& last)
{
    const auto drones = application.drones();
    const auto first = last.empty() ? application.status(drones) : std::move(last);
    const auto second = application.status(drones);
    last = application.status(drones);
    return audit(first, second, last);
}

}  // namespace hive
