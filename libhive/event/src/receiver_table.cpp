// Attaches, replaces and detaches receivers.
#include <hive/event/receiver_table.hpp>

#include <hive/name.hpp>
#include <hive/platform/process.hpp>

#include <algorithm>
#include <functional>
#include <utility>

namespace hive::event {
namespace {

bool takes_bodies(const Newcomer& newcomer) { return newcomer.options.delivery == Delivery::data; }

/// Random, from 1 to 2^52, so that no other receiver can guess it.
std::int64_t new_place() { return static_cast<std::int64_t>(platform::entropy() >> 12) + 1; }

}  // namespace

Welcome ReceiverTable::add(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions)
{
    const auto before = standing(newcomer);
    const auto ends = before ? make_way(*before, newcomer, now, decisions) : std::nullopt;
    auto welcome = newcomer.options.group.empty() ? seat(newcomer, now, decisions) : join(newcomer, now, decisions);
    welcome.ends = ends;
    for (auto& [id, seat] : seats_)  // it was disconnected after it had changed, and still has events in progress
        if (newcomer.unique && seat.receiver == newcomer.receiver && seat.run == newcomer.run && seat.heir
            && !seats_.contains(*seat.heir))
            seat.heir = newcomer.id;
    if (newcomer.unique && !seats_.at(newcomer.id).subscription().passive())
        inherit(newcomer, now, decisions);
    if (takes_bodies(newcomer) && !newcomer.guest && !held_.empty())
        offer_held(newcomer, now, decisions);
    if (ended_)
        seats_.at(newcomer.id).subscription().end(now, decisions);
    return welcome;
}

std::optional<ReceiverTable::Id> ReceiverTable::standing(const Newcomer& newcomer) const
{
    // A passive receiver replaces no other at its place.
    const auto same = [&](const Seat& seat) {
        return newcomer.unique
                   ? seat.run == newcomer.run
                   : takes_bodies(newcomer) && (seat.plain ? is_at(*seat.plain, newcomer) : is_at(seat, newcomer));
    };
    for (const auto& [id, seat] : seats_)
        if (!seat.heir && seat.receiver == newcomer.receiver && same(seat))
            return id;
    return std::nullopt;
}

/// Has it this place, or got it in a confirmation that was lost?
bool ReceiverTable::is_at(const Plain& plain, const Newcomer& newcomer)
{
    return plain.place == newcomer.place
           || (newcomer.tried != 0 && plain.tried == newcomer.tried && plain.run == newcomer.run);
}

/// Does it return to this place in its group?
bool ReceiverTable::is_at(const Seat& seat, const Newcomer& newcomer) const
{
    const auto group = groups_.find(newcomer.options.group);
    return newcomer.taken && group != groups_.end() && &group->second == seat.group && newcomer.place == seat.place
           && seat.place == seat.group->members.at(seat.receiver).place;
}

/// @return `before`, if it ends now
std::optional<ReceiverTable::Id> ReceiverTable::make_way(Id before, const Newcomer& newcomer, Clock::time_point now,
                                                         Decisions& decisions)
{
    Seat& seat = seats_.at(before);
    const bool goes_on =
        seat.plain ? newcomer.options.group.empty() && &plain_for(newcomer) == seat.plain : is_at(seat, newcomer);
    if (goes_on) {
        unregister(seat.plain ? seat.plain->registered : seat.group->members.at(seat.receiver).registered);
        seats_.erase(before);
        bequeath(before, newcomer.id);
        return before;
    }
    if (newcomer.drains) {
        seat.heir = newcomer.id;
        seat.subscription().retire(before);
        return std::nullopt;
    }
    depart(before, Fate::lost_connection, true, now, decisions);
    return before;
}

/// Its place; or that of its name, if it is a drone or had it in an earlier run of this drone; or the record of its
/// name. Two connected drones of one name have separate places.
ReceiverTable::Plain& ReceiverTable::plain_for(const Newcomer& newcomer)
{
    const auto find = [&](auto fits) {
        return std::ranges::find_if(plain_, [&](const Plain& plain) {
            return plain.receiver == newcomer.receiver && !plain.subscription.retiring() && fits(plain);
        });
    };
    const auto in_use = [](const Plain& plain) { return plain.subscription.present() || plain.subscription.awaited(); };
    auto found = plain_.end();
    if (!newcomer.guest && takes_bodies(newcomer))
        found = find([&](const Plain& plain) { return is_at(plain, newcomer) && in_use(plain); });
    if (found == plain_.end() && newcomer.unique)
        found = find([&](const Plain& plain) {
            return plain.subscription.awaited() || (plain.subscription.present() && plain.run == newcomer.run);
        });
    if (found == plain_.end() && newcomer.place == 0 && takes_bodies(newcomer))
        found = find([](const Plain& plain) { return plain.registered.newest == 0; });
    if (found == plain_.end())
        found = find([&](const Plain& plain) { return !in_use(plain) && (newcomer.unique || is_at(plain, newcomer)); });
    if (found != plain_.end())
        return *found;
    return plain_.emplace_back(
        Plain{.receiver = newcomer.receiver,
              .subscription = Subscription({.receiver = newcomer.receiver, .application = !newcomer.unique}),
              .unique = newcomer.unique});
}

Welcome ReceiverTable::seat(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions)
{
    Plain& plain = plain_for(newcomer);
    Subscription& subscription = plain.subscription;
    const bool goes_on = subscription.present() || subscription.awaited();
    const auto taken = plain.place == newcomer.place ? newcomer.taken : std::nullopt;
    if (!goes_on)
        plain.place = new_place();
    plain.tried = newcomer.tried;
    plain.run = newcomer.run;
    plain.registered.options = newcomer.options;
    plain.registered.newest = newcomer.epoch;
    ++plain.registered.now;
    seats_[newcomer.id] = {.receiver = newcomer.receiver,
                           .run = newcomer.run,
                           .registration = newcomer.epoch,
                           .plain = &plain,
                           .is_back = goes_on};
    subscription.set_passive(newcomer.guest || !takes_bodies(newcomer));
    const auto behind =
        subscription.attach(newcomer.id, newcomer.options, {taken, newcomer.held}, nullptr, now, decisions);
    if (!goes_on && newcomer.options.first_frame && held_.empty() && newest_
        && newest_->serves(newcomer.options.delivery))
        subscription.offer(newest_, now, decisions);
    return {.place = plain.place, .taken = behind};
}

ReceiverTable::Group& ReceiverTable::group_named(const std::string& name)
{
    const auto forgotten = forgotten_turns_.find(name);
    const Subscription::Kind kind{
        .shared_as = output_ + "#" + name,
        .epoch = epoch_,
        .earlier_jobs = forgotten == forgotten_turns_.end() ? least_turn_ : std::max(least_turn_, forgotten->second),
        .redelivers = defences_.leases};
    return groups_.try_emplace(name, Group{.subscription = Subscription(kind)}).first->second;
}

Welcome ReceiverTable::join(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions)
{
    Group& group = group_named(newcomer.options.group);
    Welcome welcome{.group = group.subscription.standing()};
    group.emptied = 0;
    group.lost.erase(newcomer.receiver);
    for (auto& [receiver, until] : group.lost)
        until = std::min(until.value_or(Clock::time_point::max()), now + Subscription::kept_for);
    Member& member = group.members[newcomer.receiver];
    const bool resumes = newcomer.taken && newcomer.place == member.place && group.subscription.may_resume(member.kept);
    welcome.place = member.place = resumes ? member.place : new_place();
    member.registered.options = newcomer.options;
    member.registered.newest = newcomer.epoch;
    ++member.registered.now;
    seats_[newcomer.id] = {.receiver = newcomer.receiver,
                           .run = newcomer.run,
                           .registration = newcomer.epoch,
                           .group = &group,
                           .place = member.place};
    member.kept.local = newcomer.local;
    const Subscription::Kept kept{resumes ? newcomer.taken : std::nullopt, newcomer.held};
    welcome.taken = group.subscription.attach(newcomer.id, newcomer.options, kept, &member.kept, now, decisions);
    return welcome;
}

/// Moves the events that wait at its old registration for no other receiver: from a plain receiver to its group, and
/// back if it was the last member.
void ReceiverTable::inherit(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions)
{
    const Seat& seat = seats_.at(newcomer.id);
    for (Plain& plain : plain_)
        if (seat.group && plain.receiver == newcomer.receiver && !plain.subscription.present())
            seat.subscription().adopt(std::move(plain.subscription), false, now, decisions);
    for (auto& [name, group] : groups_)
        if (&group != seat.group && was_last(group, newcomer, now, decisions) && !seat.is_back)
            seat.subscription().adopt(std::move(group.subscription), false, now, decisions);
}

/// Was it the last member of this group, which waits for no other?
bool ReceiverTable::was_last(Group& group, const Newcomer& newcomer, Clock::time_point now, Decisions& decisions)
{
    const bool was_lost = group.lost.erase(newcomer.receiver) > 0;
    const auto member = group.members.find(newcomer.receiver);
    const bool was_member = member != group.members.end();
    if (was_member)
        group.subscription.forget_away(member->second.kept, now, decisions);
    return (was_lost || was_member) && !group.subscription.present() && group.lost.empty();
}

void ReceiverTable::offer_held(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions)
{
    for (const auto& event : std::exchange(held_, {}))
        seats_.at(newcomer.id).subscription().offer(event, now, decisions);
}

void ReceiverTable::end(Clock::time_point now, Decisions& decisions)
{
    if (std::exchange(ended_, true))
        return;
    for (Plain& plain : plain_)
        plain.subscription.end(now, decisions);
    for (auto& [name, group] : groups_)
        group.subscription.end(now, decisions);
}

void ReceiverTable::go_on(Decisions& decisions)
{
    if (!std::exchange(ended_, false))
        return;
    for (Plain& plain : plain_)
        plain.subscription.go_on(decisions);
    for (auto& [name, group] : groups_)
        group.subscription.go_on(decisions);
}

bool ReceiverTable::told_end(Id id) const
{
    const auto found = seats_.find(id);
    return found != seats_.end() && found->second.subscription().told_end(id);
}

void ReceiverTable::leave(Id id, Clock::time_point now, Decisions& decisions)
{
    depart(id, Fate::lost_left, false, now, decisions);
}

void ReceiverTable::lose(Id id, Fate how, bool returns, Clock::time_point now, Decisions& decisions)
{
    depart(id, how, returns && defences_.places, now, decisions);
}

void ReceiverTable::depart(Id id, Fate how, bool returns, Clock::time_point now, Decisions& decisions)
{
    const auto found = seats_.extract(id);
    if (found.empty())
        return;
    const Seat& seat = found.mapped();
    if (seat.heir)
        bequeath(id, *seat.heir);
    if (seat.group) {
        forget_expired(*seat.group, now);
        returns = returns || (how == Fate::lost_left && !seat.group->lost.empty());
    }
    Subscription& subscription = seat.subscription();
    const auto heir = seat.heir ? seats_.find(*seat.heir) : seats_.end();
    if (heir == seats_.end() || &heir->second.subscription() == &subscription
        || heir->second.subscription().passive()) {
        subscription.detach(id, how, returns, now, decisions);
    } else {  // its unfinished events in progress move along
        const bool last = !subscription.present();
        subscription.detach(id, last ? Fate::lost_connection : how, true, now, decisions);
        if (last)
            heir->second.subscription().adopt(std::move(subscription), how == Fate::lost_left, now, decisions);
    }
    departed(seat, how, heir != seats_.end(), returns, now, decisions);
    forget_awaited();
    forget_gone();
    forget_empty_groups(decisions);
}

/// Registrations that `before` was to replace, which is gone, are replaced by its heir.
void ReceiverTable::bequeath(Id before, Id heir)
{
    for (auto& [id, seat] : seats_)
        if (seat.heir == before)
            seat.heir = heir;
}

void ReceiverTable::departed(const Seat& seat, Fate how, bool followed, bool returns, Clock::time_point now,
                             Decisions& decisions)
{
    if (seat.plain) {
        unregister(seat.plain->registered);
        const Plain& plain = *seat.plain;
        if (how == Fate::lost_left && !plain.unique && plain.registered.now == 0 && !plain.subscription.awaited())
            plain_.remove_if([&](const Plain& each) { return &each == seat.plain; });
        return;
    }
    const auto member = seat.group->members.find(seat.receiver);
    unregister(member->second.registered);
    const bool left = how == Fate::lost_left || followed;
    if (!left && member->second.registered.now == 0 && (returns || seat.group->subscription.awaited()))
        remember_lost(*seat.group, seat.receiver, now);
    const auto away =
        std::ranges::count_if(seat.group->members, [](auto& row) { return row.second.kept.away.has_value(); });
    if (seat.place == member->second.place && (left || away > static_cast<std::ptrdiff_t>(max_awaited)))
        seat.group->subscription.forget_away(member->second.kept, now, decisions);
}

/// Once the last member is lost, there is no limit for the lost members to return.
void ReceiverTable::remember_lost(Group& group, const std::string& receiver, Clock::time_point now)
{
    if (group.lost.size() < max_gone)
        group.lost.insert_or_assign(receiver, now + Subscription::kept_for);
    if (group.subscription.awaited())
        for (auto& [each, until] : group.lost)
            until.reset();
}

/// Forgets lost members that have not returned in time.
void ReceiverTable::forget_expired(Group& group, Clock::time_point now)
{
    std::erase_if(group.lost, [&](const auto& row) { return row.second && *row.second <= now; });
}

void ReceiverTable::unregister(Registered& registered)
{
    if (--registered.now == 0)
        registered.gone = ++order_;
}

/// Stops waiting for the receiver that was lost first, if there are too many.
void ReceiverTable::forget_awaited()
{
    std::size_t awaited = 0;
    Plain* first = nullptr;
    for (Plain& plain : plain_)
        if (plain.subscription.awaited()) {
            ++awaited;
            first = first && first->registered.gone < plain.registered.gone ? first : &plain;
        }
    if (awaited > max_awaited)
        first->subscription.stop_waiting();
}

/// Forgets the oldest receivers that are gone and not awaited, if there are too many.
void ReceiverTable::forget_gone()
{
    std::map<std::uint64_t, std::function<void()>> old;  // the oldest first
    for (auto it = plain_.begin(); it != plain_.end(); ++it)
        if (it->registered.now == 0 && !it->subscription.awaited())
            old.emplace(it->registered.gone, [this, it] { plain_.erase(it); });
    for (auto& [name, group] : groups_)
        for (auto it = group.members.begin(); it != group.members.end(); ++it)
            if (it->second.registered.now == 0 && !it->second.kept.away)
                old.emplace(it->second.registered.gone, [&members = group.members, it] { members.erase(it); });
    for (auto oldest = old.begin(); old.size() > max_gone; oldest = old.erase(oldest))
        oldest->second();
}

void ReceiverTable::stop_waiting(Group& group, Decisions& decisions)
{
    group.subscription.cancel(decisions);
    group.lost.clear();
}

/// Stops waiting for the group that has been awaited for longest, if there are too many, and forgets the one that has
/// been without members for longest of those that are not awaited.
void ReceiverTable::forget_empty_groups(Decisions& decisions)
{
    std::map<std::uint64_t, std::string> empty, awaited;
    for (auto& [name, group] : groups_) {
        if (group.subscription.attached())
            continue;
        group.emptied = group.emptied != 0 ? group.emptied : ++order_;
        (group.subscription.awaited() ? awaited : empty).emplace(group.emptied, name);
    }
    for (auto oldest = awaited.begin(); awaited.size() > max_awaited; oldest = awaited.erase(oldest))
        stop_waiting(groups_.at(oldest->second), decisions);
    for (auto oldest = empty.begin(); empty.size() > max_empty_groups; oldest = empty.erase(oldest)) {
        auto& subscription = groups_.at(oldest->second).subscription;
        subscription.give_up(decisions);
        forgotten_turns_[oldest->second] = subscription.standing().turn;
        if (forgotten_turns_.size() > max_forgotten_groups) {
            least_turn_ = std::max(least_turn_, forgotten_turns_.begin()->second);
            forgotten_turns_.erase(forgotten_turns_.begin());
        }
        groups_.erase(oldest->second);
    }
}

void ReceiverTable::request(Id id, std::int64_t epoch, const Progress& progress, const std::vector<std::int64_t>& back,
                            Clock::time_point now, Decisions& decisions)
{
    if (const auto found = seats_.find(id); found != seats_.end() && found->second.registration == epoch)
        found->second.subscription().request(id, progress, back, now, decisions);
}

void ReceiverTable::written(Id id, std::size_t bytes, Clock::time_point now, Decisions& decisions)
{
    if (const auto found = seats_.find(id); found != seats_.end())
        found->second.subscription().written(id, bytes, now, decisions);
}

void ReceiverTable::offer(const EmissionPtr& event, bool hold, Clock::time_point now, Decisions& decisions)
{
    // A passive receiver or a stored event must not delay the acknowledgement, since the next event may wait for it.
    const auto kept = event->event().ticket.owed() ? event->without_ticket() : event;
    const bool whole = event->serves(Delivery::data);
    bool received = false;
    go_on(decisions);  // even for receivers that do not get this event
    const bool held = hold && whole && event->lossless() && !awaited();
    for (Plain& plain : plain_) {
        Subscription& to = plain.subscription;
        if (to.missing()   ? !held
            : to.awaited() ? whole
                           : to.present() && event->serves(plain.registered.options.delivery)) {
            to.offer(to.active() ? event : kept, now, decisions);
            received = received || to.present() || to.awaited();
        }
    }
    for (auto& [name, group] : groups_)
        if (whole && (group.subscription.present() || group.subscription.awaited())) {
            group.subscription.offer(event, now, decisions);
            received = received || group.subscription.present() || group.subscription.awaited();
        }
    if (held)
        held_.push_back(event);
    else if (!received)
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
    for (Plain& plain : plain_)
        plain.subscription.tick(now, decisions);
    for (auto& [name, group] : groups_) {
        group.subscription.tick(now, decisions);
        forget_expired(group, now);
        if (group.subscription.awaited() && group.lost.empty())
            stop_waiting(group, decisions);
        for (auto& [receiver, member] : group.members)
            if (member.kept.away && member.kept.away->since + Subscription::kept_for <= now)
                group.subscription.forget_away(member.kept, now, decisions);
    }
}

void ReceiverTable::expect(const Subscriber& subscriber, std::optional<Clock::time_point> until)
{
    if (!subscriber.group.empty()) {
        Group& group = group_named(subscriber.group);
        group.lost.emplace(subscriber.receiver, until);
        return group.subscription.expect(std::nullopt, subscriber.missed);
    }
    const bool unique = subscriber.pid == 0;
    Plain& plain = plain_.emplace_back(
        Plain{.receiver = subscriber.receiver,
              .subscription = Subscription({.receiver = subscriber.receiver, .application = !unique}),
              .unique = unique});
    plain.place = new_place();
    plain.registered.gone = ++order_;
    if (subscriber.dormant)
        plain.subscription.go_on_missing(subscriber.missed);
    else
        plain.subscription.expect(until, subscriber.missed);
}

std::int64_t ReceiverTable::missed(Id id) const
{
    const auto found = seats_.find(id);
    return found == seats_.end() ? 0 : found->second.subscription().missed().count;
}

std::vector<ReceiverTable::Id> ReceiverTable::registered(const std::string& drone) const
{
    std::vector<Id> ids;
    for (const auto& [id, seat] : seats_)
        if (belongs_to(seat.receiver, drone))
            ids.push_back(id);
    return ids;
}

std::size_t ReceiverTable::forget(const std::string& drone, Decisions& decisions)
{
    std::size_t forgotten = 0;
    for (Plain& plain : plain_)
        if (plain.subscription.awaited() && belongs_to(plain.receiver, drone)) {
            plain.subscription.cancel(decisions);
            ++forgotten;
        } else if (plain.subscription.missing() && belongs_to(plain.receiver, drone)) {
            plain.subscription.cancel(decisions);
        }
    for (auto& [name, group] : groups_) {
        const auto of_drone = [&](const auto& row) { return belongs_to(row.first, drone); };
        const bool waited = std::erase_if(group.lost, of_drone) > 0 && group.subscription.awaited();
        forgotten += waited ? 1 : 0;
        for (auto& [receiver, member] : group.members)
            if (belongs_to(receiver, drone) && member.kept.away) {
                member.kept.away->since -= Subscription::kept_for;  // the next tick forgets it
                forgotten += waited ? 0 : 1;
            }
        if (waited && group.lost.empty())
            stop_waiting(group, decisions);
    }
    return forgotten;
}

}  // namespace hive::event
