// Joining receivers, groups and accounts.
#include <hive/event/receiver_table.hpp>

#include <algorithm>
#include <utility>

namespace hive::event {

ReceiverTable::Account& ReceiverTable::account(const std::string& receiver, std::int64_t epoch,
                                               const ConnectionOptions& options)
{
    Account& account = accounts_[{receiver, options.group}];
    account.options = options;
    account.registration = std::max(account.registration, epoch);
    ++account.registrations;
    return account;
}

/// Who left has no account any longer, unless a place is kept that writes into it; of those that were lost the oldest
/// goes when there are too many.
void ReceiverTable::close_account(const Key& key, bool left)
{
    const auto found = accounts_.find(key);
    if (found == accounts_.end() || --found->second.registrations > 0)
        return;
    const auto writes = [&](const auto& row) { return Key(row.second.receiver(), row.second.options().group) == key; };
    if (left && std::ranges::none_of(kept_, writes)) {
        accounts_.erase(found);
        return;
    }
    found->second.lost = ++order_;
    forget_old_accounts();
}

/// A kept place still writes into its account.
void ReceiverTable::forget_old_accounts()
{
    std::set<Key> used;
    for (const auto& [place, line] : kept_)
        used.insert({line.receiver(), line.options().group});
    std::map<std::uint64_t, Key> old;  // the oldest first
    for (const auto& [key, account] : accounts_)
        if (account.lost != 0 && account.registrations == 0 && !used.contains(key))
            old.emplace(account.lost, key);
    for (auto oldest = old.begin(); old.size() > most_old_accounts; oldest = old.erase(oldest))
        accounts_.erase(oldest->second);
}

Welcome ReceiverTable::add(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions)
{
    Account& account = this->account(newcomer.receiver, newcomer.epoch, newcomer.options);
    const auto welcome =
        newcomer.options.group.empty() ? seat(newcomer, account, decisions) : join(newcomer, account, now, decisions);
    if (newcomer.options.delivery == Delivery::data && !newcomer.guest && !held_.empty())
        offer_held(newcomer, now, decisions);
    return welcome;
}

std::map<std::int64_t, Line>::iterator ReceiverTable::kept_for(const Newcomer& newcomer)
{
    const auto before = newcomer.place == 0 ? std::nullopt : holder(newcomer.place);
    if (before && seats_.at(*before).line.receiver() == newcomer.receiver
        && newcomer.options.delivery == Delivery::data) {
        auto seat = seats_.extract(*before);
        close_account({seat.mapped().line.receiver(), ""}, false);
        kept_.emplace(newcomer.place, std::move(seat.mapped().line));
    }
    if (newcomer.place != 0) {
        const auto kept = kept_.find(newcomer.place);
        return kept != kept_.end() && kept->second.receiver() == newcomer.receiver ? kept : kept_.end();
    }
    return std::ranges::find_if(
        kept_, [&](const auto& row) { return newcomer.unique && row.second.receiver() == newcomer.receiver; });
}

Welcome ReceiverTable::seat(const Newcomer& newcomer, Account& account, Decisions& decisions)
{
    const auto& [id, receiver, epoch, options, place, taken, unique, guest] = newcomer;
    if (const auto kept = guest ? kept_.end() : kept_for(newcomer);
        kept != kept_.end() && options.delivery == Delivery::data) {
        const Seat& seat = seats_.emplace(id, Seat{std::move(kept->second), kept->first}).first->second;
        kept_.erase(kept);
        const auto behind = seats_.at(id).line.resume(id, epoch, options, place != 0 ? taken : std::nullopt, decisions);
        seats_.at(id).line.pump(decisions);
        return {.place = seat.place, .taken = behind};
    }
    const auto fresh = epoch_ + static_cast<std::int64_t>(id);
    Line& line =
        seats_.emplace(id, Seat{Line(id, receiver, epoch, options, account.ledger, guest), fresh}).first->second.line;
    if (options.first_frame && held_.empty() && newest_ && newest_->serves(options.delivery))
        line.offer(newest_, decisions);
    return {.place = fresh};
}

Welcome ReceiverTable::join(const Newcomer& newcomer, Account& account, Clock::time_point now, Decisions& decisions)
{
    const std::string& name = newcomer.options.group;
    auto found = groups_.find(name);
    if (found == groups_.end()) {
        Account& all = accounts_[{"group " + name, name}];
        all.options.group = name;
        found = groups_.try_emplace(name, output_ + "#" + name, epoch_, all.ledger, defences_.leases).first;
    }
    const Welcome welcome{.group = found->second.standing()};
    emptied_.erase(name);
    members_[newcomer.id] = name;
    found->second.join(newcomer.id, newcomer.receiver, newcomer.epoch, newcomer.options, account.ledger, now,
                       decisions);
    return welcome;
}

void ReceiverTable::offer_held(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions)
{
    for (const auto& event : std::exchange(held_, {}))
        if (const auto group = members_.find(newcomer.id); group != members_.end())
            groups_.at(group->second).offer(event, now, decisions);
        else
            seats_.at(newcomer.id).line.offer(event, decisions);
}

Group* ReceiverTable::group_of(Id id)
{
    const auto found = members_.find(id);
    return found == members_.end() ? nullptr : &groups_.at(found->second);
}

void ReceiverTable::leave(Id id, Clock::time_point now, Decisions& decisions)
{
    if (const auto found = seats_.find(id); found != seats_.end()) {
        Line line = std::move(found->second.line);
        seats_.erase(found);
        line.clear(Fate::lost_left);
        close_account({line.receiver(), line.options().group}, true);
        return;
    }
    if (Group* group = group_of(id)) {
        const Key key{group->receiver(id), members_.at(id)};
        group->leave(id, now, decisions);
        members_.erase(id);
        close_account(key, true);
        forget_oldest(decisions);
    }
}

void ReceiverTable::lose(Id id, Fate how, bool returns, Clock::time_point now, Decisions& decisions)
{
    if (const auto found = seats_.find(id); found != seats_.end()) {
        Seat seat = std::move(found->second);
        seats_.erase(found);
        const Key key{seat.line.receiver(), ""};
        if (seat.line.lose(how, returns && defences_.places, now))
            kept_.emplace(seat.place, std::move(seat.line));
        close_account(key, false);
        return;
    }
    if (Group* group = group_of(id)) {
        const Key key{group->receiver(id), members_.at(id)};
        group->lose(id, how, now, decisions);
        members_.erase(id);
        close_account(key, false);
        forget_oldest(decisions);
    }
}

/// Of the groups that nobody waits for, the one without members for longest, if there are too many.
void ReceiverTable::forget_oldest(Decisions& decisions)
{
    for (const auto& [name, group] : groups_)
        if (!group.active())
            emptied_.try_emplace(name, ++order_);
    while (emptied_.size() > most_empty_groups) {
        const auto oldest = std::ranges::min_element(emptied_, {}, [](const auto& row) { return row.second; });
        groups_.at(oldest->first).forget(decisions);
        groups_.erase(oldest->first);
        accounts_.erase({"group " + oldest->first, oldest->first});
        emptied_.erase(oldest);
    }
}

void ReceiverTable::request(Id id, std::int64_t epoch, const Progress& progress, const std::vector<std::int64_t>& back,
                            Clock::time_point now, Decisions& decisions)
{
    if (const auto found = seats_.find(id); found != seats_.end())
        found->second.line.request(epoch, progress, decisions);
    else if (Group* group = group_of(id))
        group->request(id, epoch, progress, back, now, decisions);
}

void ReceiverTable::written(Id id, std::size_t bytes, Clock::time_point now, Decisions& decisions)
{
    if (const auto found = seats_.find(id); found != seats_.end())
        found->second.line.written(bytes, decisions);
    else if (Group* group = group_of(id))
        group->written(id, bytes, now, decisions);
}

void ReceiverTable::offer(const EmissionPtr& event, bool hold, Clock::time_point now, Decisions& decisions)
{
    // Whoever only keeps or watches an event must not hold up its acknowledgement: the next one may not come before.
    const auto kept = event->event().custody ? event->without_custody() : event;
    const bool whole = event->serves(Delivery::data);
    bool received = false;
    for (auto& [id, seat] : seats_)
        if (event->serves(seat.line.options().delivery)) {
            seat.line.offer(seat.line.awaited() ? event : kept, decisions);
            received = true;
        }
    for (auto& [place, line] : kept_)
        if (whole)
            line.offer(event, decisions);
    for (auto& [name, group] : groups_)
        if (whole && group.active()) {
            group.offer(event, now, decisions);
            received = true;
        }
    if (hold && whole && event->lossless() && !awaited())
        held_.push_back(event);
    else if (!received && kept_.empty())
        ++unreceived_;
    newest_ = kept;
}

void ReceiverTable::release_held()
{
    unreceived_ += static_cast<std::int64_t>(held_.size());
    held_.clear();
}

void ReceiverTable::tick(Clock::time_point now, Decisions& decisions)
{
    for (auto it = kept_.begin(); it != kept_.end();) {
        const auto place = it++;
        if (place->second.overdue(now)) {
            place->second.expire();
            kept_.erase(place);
        }
    }
    for (auto& [name, group] : groups_)
        group.tick(now, decisions);
}

std::size_t ReceiverTable::forget(const std::string& drone, Decisions& decisions)
{
    std::size_t forgotten = 0;
    const auto of_drone = [&](const Line& line) {
        return line.receiver() == drone || line.receiver().starts_with(drone + ".");
    };
    for (auto it = kept_.begin(); it != kept_.end();) {
        const auto place = it++;
        if (of_drone(place->second)) {
            place->second.clear(Fate::lost_left);
            kept_.erase(place);
            ++forgotten;
        }
    }
    for (auto& [name, group] : groups_)
        if (group.awaited() && group.lost(drone)) {
            group.forget(decisions);
            ++forgotten;
        }
    return forgotten;
}

std::optional<ReceiverTable::Id> ReceiverTable::holder(std::int64_t place) const
{
    const auto found = std::ranges::find(seats_, place, [](const auto& row) { return row.second.place; });
    return found == seats_.end() ? std::nullopt : std::optional(found->first);
}

bool ReceiverTable::wanted() const noexcept
{
    return awaited() || std::ranges::any_of(seats_, [](const auto& row) { return row.second.line.takes_bodies(); });
}

bool ReceiverTable::awaited() const noexcept
{
    return !kept_.empty() || std::ranges::any_of(groups_, [](const auto& row) { return row.second.active(); })
           || std::ranges::any_of(seats_, [](const auto& row) { return row.second.line.awaited(); });
}

bool ReceiverTable::asked() const
{
    const auto line_asks = [](const auto& row) { return !row.second.line.awaited() || row.second.line.asks(); };
    const auto group_asks = [](const auto& row) { return !row.second.active() || row.second.asks(); };
    return kept_.empty() && awaited() && std::ranges::all_of(seats_, line_asks)
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
    if (!awaited())
        return Reason::no_receiver;
    if (!kept_.empty())
        return Reason::place_kept;
    for (const auto& [name, group] : groups_)
        if (group.active() && group.why() != Reason::none)
            return group.why();
    for (const auto& [id, seat] : seats_)
        if (seat.line.awaited() && seat.line.why() != Reason::none)
            return seat.line.why();
    return Reason::none;
}

std::vector<ReceiverTable::Row> ReceiverTable::rows() const
{
    std::map<Key, Row> rows;
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
        Row& row = rows[{"group " + name, name}];
        row.status.group = true;
        row.status.connected = group.active();
        row.status.waiting = group.waiting();
        row.status.why = group.active() ? group.why() : Reason::none;
    }
    std::vector<Row> list;
    for (auto& [key, row] : rows)
        list.push_back(std::move(row));
    std::ranges::stable_sort(list, {}, [](const Row& row) { return std::pair(row.id == 0, row.status.group); });
    return list;
}

}  // namespace hive::event
