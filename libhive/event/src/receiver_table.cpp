// Joining receivers, groups and accounts.
#include <hive/event/receiver_table.hpp>

#include <algorithm>
#include <utility>

namespace hive::event {

void ReceiverTable::close_account(const Accounts::Key& key, bool left)
{
    accounts_.close(key, left, [this](const Accounts::Key& account) {
        return std::ranges::any_of(kept_, [&](const auto& row) {
            return Accounts::Key(row.second.receiver(), row.second.options().group) == account;
        });
    });
}

Welcome ReceiverTable::add(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions)
{
    if (const auto before = standing(newcomer))
        displace(*before, newcomer, now, decisions);
    Account& account = accounts_.open(newcomer.receiver, newcomer.epoch, newcomer.options);
    const auto welcome = newcomer.options.group.empty() ? seat(newcomer, account, now, decisions)
                                                        : join(newcomer, account, now, decisions);
    if (newcomer.options.delivery == Delivery::data && !newcomer.guest && !held_.empty())
        offer_held(newcomer, now, decisions);
    if (ended_)
        tell_end(newcomer, now, decisions);
    return welcome;
}

std::optional<ReceiverTable::Id> ReceiverTable::standing(const Newcomer& newcomer) const
{
    const bool data = newcomer.options.delivery == Delivery::data;  // who merely watches pushes nobody from its place
    for (const auto& [id, seat] : seats_)
        if (seat.line.receiver() == newcomer.receiver && (newcomer.unique || (data && seat.place == newcomer.place)))
            return id;
    for (const auto& [id, name] : members_)
        if (newcomer.unique && groups_.at(name).receiver(id) == newcomer.receiver)
            return id;
    return std::nullopt;
}

/// It has other options now, or is back before anybody saw that its old connection is dead. Lossless events wait for
/// it as for any that comes back.
void ReceiverTable::displace(Id before, const Newcomer& newcomer, Clock::time_point now, Decisions& decisions)
{
    const auto seat = seats_.find(before);
    if (seat == seats_.end() || !seat->second.line.takes_bodies() || !newcomer.options.group.empty()
        || newcomer.options.delivery != Delivery::data)
        return lose(before, Fate::lost_connection, false, now, decisions);
    const auto place = kept_.emplace(seat->second.place, std::move(seat->second.line)).first;
    seats_.erase(seat);
    close_account({newcomer.receiver, ""}, false);
    // The newcomer may come back to another place of its name: nobody is in this one then, and it expires as any other.
    if (kept_for(newcomer) != place && !place->second.lose(Fate::lost_connection, true, now))
        kept_.erase(place);
}

std::map<std::int64_t, Line>::iterator ReceiverTable::kept_for(const Newcomer& newcomer)
{
    const auto kept = kept_.find(newcomer.place);
    if (kept != kept_.end() && kept->second.receiver() == newcomer.receiver)
        return kept;
    return std::ranges::find_if(
        kept_, [&](const auto& row) { return newcomer.unique && row.second.receiver() == newcomer.receiver; });
}

Welcome ReceiverTable::seat(const Newcomer& newcomer, Account& account, Clock::time_point now, Decisions& decisions)
{
    const auto& [id, receiver, epoch, options, place, taken, unique, guest] = newcomer;
    if (const auto kept = guest ? kept_.end() : kept_for(newcomer);
        kept != kept_.end() && options.delivery == Delivery::data) {
        Seat& seat = seats_.emplace(id, Seat{std::move(kept->second), kept->first}).first->second;
        kept_.erase(kept);
        const auto behind = seat.line.resume(id, epoch, options, seat.place == place ? taken : std::nullopt, decisions);
        seat.line.pump(decisions);
        return {.place = seat.place, .taken = behind};
    }
    const auto fresh = epoch_ + static_cast<std::int64_t>(id);
    Line& line =
        seats_.emplace(id, Seat{Line(id, receiver, epoch, options, account.ledger, guest), fresh}).first->second.line;
    if (options.first_frame && held_.empty() && newest_ && newest_->serves(options.delivery))
        line.offer(newest_, now, decisions);
    return {.place = fresh};
}

Welcome ReceiverTable::join(const Newcomer& newcomer, Account& account, Clock::time_point now, Decisions& decisions)
{
    const std::string& name = newcomer.options.group;
    auto found = groups_.find(name);
    if (found == groups_.end()) {
        Ledger& all = accounts_.group(name).ledger;
        found = groups_.try_emplace(name, output_ + "#" + name, epoch_, all, defences_.leases).first;
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
            seats_.at(newcomer.id).line.offer(event, now, decisions);
}

void ReceiverTable::tell_end(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions)
{
    if (Group* group = group_of(newcomer.id))
        group->end(now, decisions);
    else
        seats_.at(newcomer.id).line.end(decisions);
}

void ReceiverTable::end(Clock::time_point now, Decisions& decisions)
{
    if (std::exchange(ended_, true))
        return;
    for (auto& [id, seat] : seats_)
        seat.line.end(decisions);
    for (auto& [name, group] : groups_)
        group.end(now, decisions);
}

void ReceiverTable::go_on()
{
    ended_ = false;
    for (auto& [id, seat] : seats_)
        seat.line.go_on();
    for (auto& [name, group] : groups_)
        group.go_on();
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
        const Accounts::Key key{group->receiver(id), members_.at(id)};
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
        const Accounts::Key key{seat.line.receiver(), ""};
        if (seat.line.lose(how, returns && defences_.places, now))
            kept_.emplace(seat.place, std::move(seat.line));
        close_account(key, false);
        return;
    }
    if (Group* group = group_of(id)) {
        const Accounts::Key key{group->receiver(id), members_.at(id)};
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
        groups_.at(oldest->first).give_up(true, decisions);
        groups_.erase(oldest->first);
        accounts_.forget_group(oldest->first);
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
    ended_ = false;
    for (auto& [id, seat] : seats_)
        if (event->serves(seat.line.options().delivery)) {
            seat.line.offer(seat.line.awaited() ? event : kept, now, decisions);
            received = true;
        }
    for (auto it = kept_.begin(); whole && it != kept_.end();) {
        const auto place = it++;
        place->second.offer(event, now, decisions);
        if (!place->second.worth_keeping())
            expire(place);
    }
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
        if (place->second.overdue(now))
            expire(place);
    }
    for (auto& [name, group] : groups_)
        group.tick(now, decisions);
}

void ReceiverTable::expire(std::map<std::int64_t, Line>::iterator place)
{
    place->second.expire();
    kept_.erase(place);
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

}  // namespace hive::event
