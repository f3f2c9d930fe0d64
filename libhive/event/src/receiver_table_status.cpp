// The status of a receiver table: its demand, its stall reason, and its rows.
#include <hive/event/receiver_table.hpp>

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

namespace hive::event {

/// Adds the counts of another receiver of the same name.
static void add_to(Ledger& sum, const Ledger& more)
{
    sum.came(more.total());
    for (std::size_t i = 0; i < fates; ++i)
        sum.went(static_cast<Fate>(i), more.of(static_cast<Fate>(i)));
}

bool ReceiverTable::any(bool (Subscription::*like)() const) const
{
    return std::ranges::any_of(plain_, [&](const Plain& plain) { return (plain.subscription.*like)(); })
           || std::ranges::any_of(groups_, [&](const auto& row) { return (row.second.subscription.*like)(); });
}

bool ReceiverTable::awaited() const noexcept { return any(&Subscription::active); }

/// In one pass, since it is computed several times for each event.
Demand ReceiverTable::demand() const
{
    Demand demand{.backlogged = !held_.empty()};
    bool awaited = false, asked = true;
    const auto add = [&](const Subscription& one) {
        if (one.active()) {
            awaited = true;
            asked = asked && one.asks();
        }
        demand.backlogged = demand.backlogged || one.backlogged();
    };
    std::size_t plain_ones = 0;
    for (const Plain& plain : plain_) {
        const Subscription& one = plain.subscription;
        add(one);
        if (one.awaited() || (one.present() && plain.registered.options.delivery == Delivery::data))
            ++plain_ones;
    }
    for (const auto& [name, group] : groups_)
        add(group.subscription);
    demand.wanted = awaited || plain_ones > 0;
    demand.fans_out = plain_ones > 1;
    demand.asked = awaited && asked;
    return demand;
}

bool ReceiverTable::timed() const
{
    const auto is_away = [](const auto& row) { return row.second.kept.away.has_value(); };
    const auto has_limit = [](const auto& row) { return row.second.has_value(); };
    return any(&Subscription::timed) || std::ranges::any_of(groups_, [&](const auto& row) {
               const Group& group = row.second;
               return std::ranges::any_of(group.members, is_away) || std::ranges::any_of(group.lost, has_limit);
           });
}

/// Does any event wait here for a receiver?
bool ReceiverTable::waits() const { return any(&Subscription::has_waiting); }

Reason ReceiverTable::why() const
{
    if (!held_.empty())
        return Reason::held;
    if (ended_ && !waits())
        return Reason::source_ended;
    if (!awaited())
        return any(&Subscription::present) ? Reason::watched : Reason::no_receiver;
    auto reason = Reason::none;
    for (const Plain& plain : plain_)
        if (plain.subscription.awaited())
            return plain.subscription.why();
    for (const auto& [name, group] : groups_)
        if (reason == Reason::none && group.subscription.active())
            reason = group.subscription.why();
    for (const Plain& plain : plain_)
        if (reason == Reason::none && plain.subscription.active())
            reason = plain.subscription.why();
    return reason;
}

std::vector<Subscriber> ReceiverTable::subscribers() const
{
    std::vector<Subscriber> list;
    for (const Plain& plain : plain_)
        if (const auto& one = plain.subscription; !one.retiring() && (one.active() || one.misses_lossless()))
            list.push_back(
                {.output = {}, .receiver = plain.receiver, .missed = one.missed(), .dormant = !one.active()});
    for (const auto& [name, group] : groups_) {
        if (!group.subscription.active())
            continue;
        std::set<std::string> members;
        for (const auto& [receiver, until] : group.lost)
            members.insert(receiver);
        for (const auto& [id, seat] : seats_)
            if (seat.group == &group && !seat.heir)
                members.insert(seat.receiver);
        for (const auto& receiver : members)
            list.push_back({.output = {}, .receiver = receiver, .group = name, .missed = group.subscription.missed()});
    }
    return list;
}

/// 0: the row of its name. Applications, or two drones, that are registered under one name have separate rows.
std::int64_t ReceiverTable::row_of(const Plain& plain) const
{
    const auto is_twin = [&](const Plain& other) {
        return other.receiver == plain.receiver && other.registered.now > 0 && other.run != plain.run;
    };
    return plain.registered.now > 0 && (!plain.unique || std::ranges::any_of(plain_, is_twin)) ? plain.place : 0;
}

std::vector<ReceiverTable::Row> ReceiverTable::rows() const
{
    // By receiver and group. Registered applications have separate rows, even under one name.
    std::map<std::tuple<std::string, std::string, std::int64_t>, Row> rows;
    const auto add_registered = [](EdgeStatus& status, const std::string& receiver, const Registered& registered) {
        status.receiver = receiver;
        if (registered.newest < status.registration)
            return;
        status.registration = registered.newest;
        status.options = registered.options;
    };
    for (const Plain& plain : plain_) {
        Row& row = rows[{plain.receiver, "", row_of(plain)}];
        EdgeStatus& status = row.status;
        add_registered(status, plain.receiver, plain.registered);
        add_to(status.events, plain.subscription.ledger());
        status.last_lost_us = std::max(status.last_lost_us, plain.subscription.last_lost_us());
        status.connected = status.connected || plain.registered.now > 0;
        status.waiting += plain.subscription.waiting();
        status.why = plain.subscription.why() != Reason::none ? plain.subscription.why() : status.why;
    }
    for (const auto& [name, group] : groups_) {
        for (const auto& [receiver, member] : group.members) {
            EdgeStatus& status = rows[{receiver, name, 0}].status;
            add_registered(status, receiver, member.registered);
            status.events = member.kept.ledger;
            status.connected = member.registered.now > 0;
        }
        Row& row = rows[{"group " + name, name, 0}];
        EdgeStatus& status = row.status;
        status = {.receiver = "group " + name,
                  .group = true,
                  .connected = group.subscription.active(),
                  .events = group.subscription.ledger(),
                  .waiting = group.subscription.waiting(),
                  .last_lost_us = group.subscription.last_lost_us(),
                  .why = group.subscription.why()};
        status.options.group = name;
    }
    for (const auto& [id, seat] : seats_) {
        const auto group = std::ranges::find(groups_, seat.group, [](auto& row) { return &row.second; });
        Row& row = rows[{seat.receiver, seat.group ? group->first : "", seat.plain ? row_of(*seat.plain) : 0}];
        row.id = id;
        if (seat.group)
            row.status.why = seat.group->subscription.why(id);
    }
    std::vector<Row> list;
    for (auto& [key, row] : rows)
        list.push_back(std::move(row));
    std::ranges::stable_sort(list, {}, [](const Row& row) { return std::pair(row.id == 0, row.status.group); });
    return list;
}

}  // namespace hive::event
