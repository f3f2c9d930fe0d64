// What a table of receivers tells of itself: whether anybody wants or asks, why it stands still, and its rows.
#include <hive/event/receiver_table.hpp>

#include <algorithm>
#include <utility>

namespace hive::event {

bool ReceiverTable::wanted() const noexcept
{
    return !kept_.empty() || std::ranges::any_of(groups_, [](const auto& row) { return row.second.active(); })
           || std::ranges::any_of(seats_, [](const auto& row) { return row.second.line.takes_bodies(); });
}

bool ReceiverTable::fans_out() const
{
    const auto plain = std::ranges::count_if(seats_, [](const auto& row) { return row.second.line.takes_bodies(); });
    return plain + std::ssize(kept_) > 1;
}

bool ReceiverTable::asked() const
{
    const auto line_asks = [](const auto& row) { return !row.second.line.takes_bodies() || row.second.line.asks(); };
    const auto group_asks = [](const auto& row) { return !row.second.active() || row.second.asks(); };
    return kept_.empty() && wanted() && std::ranges::all_of(seats_, line_asks)
           && std::ranges::all_of(groups_, group_asks);
}

bool ReceiverTable::backlogged() const
{
    return !held_.empty() || std::ranges::any_of(seats_, [](const auto& row) { return row.second.line.backlogged(); })
           || std::ranges::any_of(kept_, [](const auto& row) { return row.second.backlogged(); })
           || std::ranges::any_of(groups_, [](const auto& row) { return row.second.backlogged(); });
}

bool ReceiverTable::timed() const
{
    return !kept_.empty() || std::ranges::any_of(groups_, [](const auto& row) { return row.second.leasing(); });
}

Reason ReceiverTable::why() const
{
    if (!held_.empty())
        return Reason::held;
    if (!wanted())
        return Reason::no_receiver;
    if (!kept_.empty())
        return Reason::place_kept;
    for (const auto& [name, group] : groups_)
        if (group.active() && group.why() != Reason::none)
            return group.why();
    for (const auto& [id, seat] : seats_)
        if (seat.line.takes_bodies() && seat.line.why() != Reason::none)
            return seat.line.why();
    return Reason::none;
}

std::vector<ReceiverTable::Row> ReceiverTable::rows() const
{
    std::map<Accounts::Key, Row> rows;
    for (const auto& [key, account] : accounts_) {
        Row& row = rows[key];
        row.status.receiver = key.first;
        row.status.connected = account.registrations > 0;
        row.status.registration = account.registration;
        row.status.options = account.options;
        row.status.events = account.ledger;
    }
    for (const auto& [id, seat] : seats_) {
        Row& row = rows[{seat.line.receiver(), ""}];
        row.id = id;
        row.status.waiting += seat.line.waiting();
        row.status.why = seat.line.why();
    }
    for (const auto& [place, line] : kept_) {
        rows[{line.receiver(), ""}].status.waiting += line.waiting();
        rows[{line.receiver(), ""}].status.why = line.why();
    }
    for (const auto& [id, name] : members_) {
        Row& row = rows[{groups_.at(name).receiver(id), name}];
        row.id = id;
        row.status.why = groups_.at(name).why(id);
    }
    for (const auto& [name, group] : groups_) {
        Row& row = rows[Accounts::of_group(name)];
        row.status.group = true;
        row.status.connected = group.active();
        row.status.waiting = group.waiting();
        row.status.why = group.why();
    }
    std::vector<Row> list;
    for (auto& [key, row] : rows)
        list.push_back(std::move(row));
    std::ranges::stable_sort(list, {}, [](const Row& row) { return std::pair(row.id == 0, row.status.group); });
    return list;
}

}  // namespace hive::event
