// Differences of a sender's counts between two looks.
#include "losses.hpp"

#include "format.hpp"
#include "targets.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace hivectl {
namespace {

using hive::Fate;

struct Reasoned {
    Fate fate;
    const char* reason;
};

constexpr std::array reasons{
    Reasoned{Fate::skipped, "skipped by the sender: hivectl had not asked for them in time"},
    Reasoned{Fate::dropped, "dropped by the sender: its queue for hivectl was full"},
    Reasoned{Fate::abandoned, "given up by the sender"},
    Reasoned{Fate::lost_connection, "lost when the connection broke"},
    Reasoned{Fate::lost_killed, "lost when hivectl was taken for dead"},
    Reasoned{Fate::lost_cut_off, "lost when hivectl had fallen silent and was cut off"},
    Reasoned{Fate::lost_left, "lost when hivectl left"},
};

std::vector<std::string> drones_of(const std::vector<hive::Endpoint>& outputs)
{
    std::vector<std::string> drones;
    for (const auto& output : outputs)
        add_new(drones, {output.drone});
    return drones;
}

}  // namespace

Losses::Losses(std::string receiver, std::vector<hive::Endpoint> outputs, const std::vector<hive::StatusAnswer>& now)
    : receiver_(std::move(receiver)), outputs_(std::move(outputs))
{
    for (const auto& output : outputs_)
        first_.push_back(look(output, now));
}

Losses::Look Losses::look(const hive::Endpoint& output, const std::vector<hive::StatusAnswer>& now) const
{
    const auto answer = std::ranges::find(now, output.drone, &hive::StatusAnswer::drone);
    if (answer == now.end() || answer->error)
        return {};
    const auto& outputs = answer->status.outputs;
    const auto row = std::ranges::find(outputs, output.port, &hive::OutputStatus::name);
    if (row == outputs.end())
        return {};
    Look look{.known = true, .epoch = answer->status.epoch, .elsewhere = row->produced};
    const auto edge = std::ranges::find(row->edges, receiver_, &hive::EdgeStatus::receiver);
    if (edge != row->edges.end()) {
        look.events = edge->events;
        look.elsewhere -= edge->events.total();
    }
    return look;
}

namespace {

/// How many of the events that the sender has no acknowledgement of are here.
std::int64_t arrived_unseen(const std::string& from, const hive::Ledger& since,
                            const std::vector<hive::InputStatus>& here)
{
    const auto input = std::ranges::find(here, from, &hive::InputStatus::from);
    const auto received = input == here.end() ? 0 : input->received;
    return std::max<std::int64_t>(0, received - since.of(Fate::acknowledged) - since.in_flight());
}

bool is_lost(Fate fate) { return fate >= Fate::lost_connection; }

}  // namespace

std::vector<Loss> Losses::until(const std::vector<hive::StatusAnswer>& now,
                                const std::vector<hive::InputStatus>& here) const
{
    std::vector<Loss> losses;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        const std::string from = to_text(outputs_[i]);
        const Look last = look(outputs_[i], now);
        const bool restarted = last.known && first_[i].known && last.epoch != first_[i].epoch;
        if (!last.known)
            losses.push_back({from, "not known: " + outputs_[i].drone + " does not answer", 0});
        if (restarted)
            losses.push_back({from, "not known: " + outputs_[i].drone + " was restarted", 0});
        if (!last.known || restarted || !first_[i].known)
            continue;
        auto arrived = arrived_unseen(from, last.events, here);
        for (const auto& [fate, reason] : reasons) {
            auto events = last.events.of(fate) - first_[i].events.of(fate);
            if (is_lost(fate))
                events -= std::exchange(arrived, std::max<std::int64_t>(0, arrived - events));
            if (events > 0)
                losses.push_back({from, reason, events, fate != Fate::skipped});
        }
        if (const auto events = last.elsewhere - first_[i].elsewhere; events > 0)
            losses.push_back({from, "not sent: hivectl was not connected", events});
    }
    return losses;
}

Losses losses_from_now(hive::Application& application, const std::vector<hive::Endpoint>& outputs)
{
    return {application.name(), outputs, application.status(drones_of(outputs))};
}

std::vector<Loss> losses_until_now(const Losses& losses, hive::Application& application,
                                   const std::vector<hive::Endpoint>& outputs,
                                   const std::vector<hive::InputStatus>& here)
{
    application.timeout(std::chrono::seconds(1));
    return losses.until(application.status(drones_of(outputs)), here);
}

bool promise_broken(const hive::CollectCounts& counts, const std::vector<Loss>& losses, bool ordered, bool lossless)
{
    if (!ordered && !lossless)
        return false;
    return counts.missing > 0 || counts.dropped > 0
           || std::ranges::any_of(losses, [&](const Loss& loss) { return loss.promised || lossless; });
}

std::string sentence(const Loss& loss)
{
    return loss.from + ": " + (loss.events > 0 ? count_text(loss.events, "event") + ", " : "") + loss.reason;
}

}  // namespace hivectl
