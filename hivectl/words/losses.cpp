// Each sender counts the fates of events per receiver.
#include "words/losses.hpp"

#include "words/format.hpp"
#include "words/targets.hpp"

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
    Reasoned{Fate::skipped, "skipped by the sender: hivectl had not requested them in time"},
    Reasoned{Fate::dropped, "dropped by the sender: its queue for hivectl was full"},
    Reasoned{Fate::abandoned, "given up by the sender"},
    Reasoned{Fate::lost_connection, "lost when the connection broke"},
    Reasoned{Fate::lost_killed, "lost: hivectl was presumed dead"},
    Reasoned{Fate::lost_cut_off, "lost when hivectl was silent and was disconnected"},
    Reasoned{Fate::lost_left, "lost when hivectl left"},
};

bool is_lost(Fate fate) { return fate >= Fate::lost_connection; }

/// The number of events that have arrived here without an acknowledgement at the sender.
std::int64_t arrived_unseen(const hive::Ledger& events, const hive::InputStatus& here)
{
    return std::max<std::int64_t>(0, here.received - events.of(Fate::acknowledged) - events.in_flight());
}

/// The row of this registration at its sender, null: the sender does not answer or was restarted.
const hive::EdgeStatus* row_of(const std::string& receiver, const hive::InputStatus& here,
                               const std::vector<hive::StatusAnswer>& senders)
{
    const auto from = hive::parse_endpoint(here.input);
    const auto answer = std::ranges::find(senders, from.drone, &hive::StatusAnswer::drone);
    const auto* status = answer == senders.end() ? nullptr : value_of(answer->status);
    if (!status)
        return nullptr;
    for (const auto& output : status->outputs)
        for (const auto& edge : output.edges)
            if (output.name == from.port && edge.receiver == receiver && edge.registration == here.registration)
                return &edge;
    return nullptr;
}

}  // namespace

std::vector<Loss> losses_of(const std::string& receiver, const std::vector<hive::InputStatus>& here,
                            const std::vector<hive::StatusAnswer>& senders)
{
    std::vector<Loss> losses;
    for (const auto& input : here) {
        const auto* row = row_of(receiver, input, senders);
        if (!row)
            continue;
        auto arrived = arrived_unseen(row->events, input);
        for (const auto& [fate, reason] : reasons) {
            auto events = row->events.of(fate);
            if (is_lost(fate))
                events -= std::exchange(arrived, std::max<std::int64_t>(0, arrived - events));
            if (events > 0)
                losses.push_back({input.input, reason, events, fate != Fate::skipped});
        }
    }
    return losses;
}

std::vector<Loss> losses_now(hive::Application& application, const std::vector<hive::InputStatus>& here)
{
    std::vector<std::string> drones;
    for (const auto& input : here)
        add_new(drones, {hive::parse_endpoint(input.input).drone});
    application.timeout(std::chrono::seconds(1));
    return losses_of(application.name(), here, application.status(drones));
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
    return loss.from + ": " + count_text(loss.events, "event") + ", " + loss.reason;
}

}  // namespace hivectl
