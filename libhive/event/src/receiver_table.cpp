// The decisions of the receiver table.
#include <hive/event/receiver_table.hpp>

#include <algorithm>
#include <ranges>

namespace hive::event {
namespace {

constexpr auto unknown_lease = std::chrono::seconds(30);
constexpr auto least_lease = std::chrono::seconds(2);
constexpr std::size_t times_needed = 3;
constexpr std::size_t most_lane_events = 64;

}  // namespace

bool ReceiverTable::Receiver::lane_free(std::size_t next) const
{
    return lane_events == 0 || (lane_events < most_lane_events && lane_bytes + next <= ReceiverTable::lane_bytes);
}

void ReceiverTable::WorkTimes::add(Clock::duration time) { recent_[count_++ % recent_.size()] = time; }

Clock::duration ReceiverTable::WorkTimes::lease() const
{
    if (count_ < times_needed)
        return unknown_lease;
    const auto longest = *std::ranges::max_element(recent_);
    return std::max<Clock::duration>(least_lease, 4 * longest);
}

ReceiverTable::Decisions ReceiverTable::add(Id id, std::string name, std::int64_t epoch,
                                            const ConnectionOptions& options, Clock::time_point now)
{
    Decisions decisions;
    Receiver& receiver = receivers_[id];
    receiver.name = std::move(name);
    receiver.epoch = epoch;
    receiver.options = options;
    receiver.asked = options.window;
    receiver.idle_since = ++asking_order_;
    if (!options.group.empty())
        ++groups_[options.group].members;
    if (options.delivery == Delivery::data && !held_.empty()) {
        for (const auto& event : std::exchange(held_, {}))
            if (options.group.empty())
                offer_receiver(id, receiver, event, decisions);
            else
                offer_group(options.group, groups_[options.group], event, now, decisions);
    } else if (options.first_frame && newest_ && newest_->serves(options.delivery)) {
        offer_receiver(id, receiver, newest_, decisions);
    }
    if (!options.group.empty())
        pump_group(options.group, now, decisions);
    return decisions;
}

ReceiverTable::Decisions ReceiverTable::remove(Id id, bool left, Clock::time_point now)
{
    Decisions decisions;
    const auto found = receivers_.find(id);
    if (found == receivers_.end())
        return decisions;
    Receiver receiver = std::move(found->second);
    receivers_.erase(found);
    const std::string& name = receiver.options.group;
    if (name.empty())
        return decisions;
    Group& group = groups_[name];
    --group.members;
    take_back(receiver, group, decisions);
    if (group.members == 0)
        empty(name, group, left, decisions);
    else
        pump_group(name, now, decisions);
    return decisions;
}

/// The last member is gone. What a live source made and nobody had is skipped: the next member begins with what is new
/// then.
void ReceiverTable::empty(const std::string& name, Group& group, bool left, Decisions& decisions)
{
    const auto lossless = [](const Job& job) { return job.event->lossless(); };
    if (!group.waiting.empty() && group.waiting.back().attempt == 0 && !lossless(group.waiting.back())) {
        group.waiting.pop_back();
        ++group.counts.skipped;
        --group.counts.in_flight;
    }
    if (left)
        give_up_waiting(name, group, decisions);
    group.awaited = !left && ((newest_ && newest_->lossless()) || std::ranges::any_of(group.waiting, lossless));
    group.emptied = ++emptying_order_;
    forget_oldest(decisions);
}

/// Of the groups that nobody waits for, the one without members for longest, if there are too many.
void ReceiverTable::forget_oldest(Decisions& decisions)
{
    const auto active = [](const auto& row) { return row.second.active(); };
    if (groups_.size() - static_cast<std::size_t>(std::ranges::count_if(groups_, active)) <= most_empty_groups)
        return;
    const auto oldest = std::ranges::min_element(
        groups_, {}, [&](const auto& row) { return std::pair(active(row), row.second.emptied); });
    give_up_waiting(oldest->first, oldest->second, decisions);
    groups_.erase(oldest);
}

void ReceiverTable::give_up(const Job& job, const std::string& name, Group& group, Decisions& decisions)
{
    --group.counts.in_flight;
    ++group.counts.abandoned;
    if (!defences_.leases)
        return;
    Event event = job.event->event();
    event.identity.group = job.attempt > 0 ? name : "";
    event.identity.turn = job.turn;
    event.identity.attempt = job.attempt;
    decisions.failed.push_back(std::make_shared<const Emission>(std::move(event)));
}

void ReceiverTable::give_up_waiting(const std::string& name, Group& group, Decisions& decisions)
{
    for (const auto& job : std::exchange(group.waiting, {}))
        give_up(job, name, group, decisions);
}

ReceiverTable::Decisions ReceiverTable::request(Id id, std::int64_t epoch, std::int64_t asked, std::int64_t done,
                                                Clock::time_point now)
{
    Decisions decisions;
    const auto found = receivers_.find(id);
    if (found == receivers_.end() || found->second.epoch != epoch)
        return decisions;
    Receiver& receiver = found->second;
    // Nobody may ask for more than its window beyond what it got: a peer's number allocates nothing here.
    const auto allowed = std::min(asked, receiver.sent + receiver.options.window);
    if (allowed > receiver.asked) {
        receiver.asked = allowed;
        receiver.idle_since = ++asking_order_;
    }
    acknowledge(receiver, std::min(done, receiver.sent), now);
    if (receiver.options.group.empty())
        pump(id, receiver, decisions);
    else
        pump_group(receiver.options.group, now, decisions);
    return decisions;
}

void ReceiverTable::acknowledge(Receiver& receiver, std::int64_t done, Clock::time_point now)
{
    const auto newly = done - receiver.done;
    if (newly <= 0)
        return;
    receiver.done = done;
    receiver.suspect = false;
    if (receiver.options.group.empty())
        return;
    Group& group = groups_[receiver.options.group];
    for (std::int64_t i = 0; i < newly && !receiver.leases.empty(); ++i) {
        if (receiver.leases.front().job.event) {
            ++group.counts.delivered;
            --group.counts.in_flight;
            ++receiver.counts.delivered;
            --receiver.counts.in_flight;
            if (i == 0)
                group.times.add(now - receiver.head_since);
        }
        receiver.leases.pop_front();
    }
    receiver.head_since = now;
}

ReceiverTable::Decisions ReceiverTable::written(Id id, std::size_t size, Clock::time_point now)
{
    Decisions decisions;
    const auto found = receivers_.find(id);
    if (found == receivers_.end())
        return decisions;
    Receiver& receiver = found->second;
    --receiver.lane_events;
    receiver.lane_bytes -= size;
    if (!receiver.options.group.empty()) {
        pump_group(receiver.options.group, now, decisions);
        return decisions;
    }
    ++receiver.counts.delivered;
    --receiver.counts.in_flight;
    pump(id, receiver, decisions);
    return decisions;
}

ReceiverTable::Decisions ReceiverTable::offer(EmissionPtr event, bool hold, Clock::time_point now)
{
    // Whoever only keeps or watches an event must not hold up its acknowledgement: the next one may not come before
    // that.
    const auto kept = event->event().receipt ? event->without_receipt() : event;
    Decisions decisions;
    const bool whole = event->serves(Delivery::data);
    if (hold && whole && event->lossless() && !wanted())
        held_.push_back(event);
    for (auto& [id, receiver] : receivers_)
        if (receiver.options.group.empty() && event->serves(receiver.options.delivery))
            offer_receiver(id, receiver, receiver.options.delivery == Delivery::notification ? kept : event, decisions);
    for (auto& [name, group] : groups_)
        if (whole && group.active())
            offer_group(name, group, event, now, decisions);
    newest_ = kept;
    return decisions;
}

void ReceiverTable::offer_receiver(Id id, Receiver& receiver, const EmissionPtr& event, Decisions& decisions)
{
    ++receiver.counts.produced;
    ++receiver.counts.in_flight;
    const auto must_stay = [&](const EmissionPtr& each) {
        return each->lossless() && receiver.options.delivery == Delivery::data;
    };
    if (!receiver.streaming() && !must_stay(event) && !receiver.waiting.empty()
        && !must_stay(receiver.waiting.back())) {
        receiver.waiting_bytes -= receiver.waiting.back()->size();
        receiver.waiting.pop_back();
        ++receiver.counts.skipped;
        --receiver.counts.in_flight;
    }
    receiver.waiting.push_back(event);
    receiver.waiting_bytes += event->size();
    pump(id, receiver, decisions);
    if (receiver.streaming())
        drop_oldest(receiver);
}

void ReceiverTable::drop_oldest(Receiver& receiver)
{
    const auto over = [&] {
        return receiver.waiting.size() > most_queued_events
               || (receiver.waiting.size() > 1 && receiver.waiting_bytes > most_queued_bytes);
    };
    while (over()) {
        if (receiver.waiting.front()->lossless() && receiver.options.delivery == Delivery::data)
            return;
        receiver.waiting_bytes -= receiver.waiting.front()->size();
        receiver.waiting.pop_front();
        ++receiver.counts.dropped;
        --receiver.counts.in_flight;
    }
}

void ReceiverTable::pump(Id id, Receiver& receiver, Decisions& decisions)
{
    while (!receiver.waiting.empty() && receiver.has_credit() && receiver.lane_free(receiver.waiting.front()->size())) {
        EmissionPtr event = std::move(receiver.waiting.front());
        receiver.waiting.pop_front();
        receiver.waiting_bytes -= event->size();
        ++receiver.sent;
        ++receiver.lane_events;
        receiver.lane_bytes += event->size();
        decisions.sends.push_back({id, std::move(event), receiver.options.delivery, {}});
    }
}

void ReceiverTable::offer_group(const std::string& name, Group& group, const EmissionPtr& event, Clock::time_point now,
                                Decisions& decisions)
{
    ++group.counts.produced;
    ++group.counts.in_flight;
    const bool replaces = !event->lossless() && !group.waiting.empty() && group.waiting.back().attempt == 0
                          && !group.waiting.back().event->lossless();
    if (replaces) {
        group.waiting.pop_back();
        ++group.counts.skipped;
        --group.counts.in_flight;
    }
    group.waiting.push_back({event});
    pump_group(name, now, decisions);
}

ReceiverTable::Receiver* ReceiverTable::next_member(const std::string& group, std::size_t size, Id& id)
{
    Receiver* best = nullptr;
    for (auto& [member_id, member] : receivers_) {
        if (member.options.group != group || member.suspect || !member.has_credit() || !member.lane_free(size))
            continue;
        if (!best
            || std::pair(member.leases.size(), member.idle_since) < std::pair(best->leases.size(), best->idle_since)) {
            best = &member;
            id = member_id;
        }
    }
    return best;
}

void ReceiverTable::pump_group(const std::string& name, Clock::time_point now, Decisions& decisions)
{
    Group& group = groups_[name];
    Id id = 0;
    while (!group.waiting.empty()) {
        Receiver* member = next_member(name, group.waiting.front().event->size(), id);
        if (!member)
            return;
        Job job = std::move(group.waiting.front());
        group.waiting.pop_front();
        if (++job.attempt == 1)
            job.turn = ++group.turns;
        if (member->leases.empty())
            member->head_since = now;
        ++member->sent;
        ++member->lane_events;
        member->lane_bytes += job.event->size();
        ++member->counts.produced;
        ++member->counts.in_flight;
        decisions.sends.push_back({id, job.event, Delivery::data, {name, job.turn, job.attempt}});
        member->leases.push_back({std::move(job)});
    }
}

void ReceiverTable::take_back(Receiver& member, Group& group, Decisions& decisions)
{
    for (auto& lease : member.leases | std::views::reverse) {
        if (!lease.job.event)
            continue;
        Job job = std::exchange(lease.job, {});
        --member.counts.in_flight;
        ++member.counts.abandoned;
        if (defences_.leases && job.attempt < most_attempts)
            group.waiting.push_front(std::move(job));
        else
            give_up(job, member.options.group, group, decisions);
    }
}

Clock::duration ReceiverTable::lease_of(const Receiver& member) const
{
    return member.options.lease ? Clock::duration(*member.options.lease)
                                : groups_.at(member.options.group).times.lease();
}

ReceiverTable::Decisions ReceiverTable::tick(Clock::time_point now)
{
    Decisions decisions;
    for (auto& [id, member] : receivers_) {
        if (member.options.group.empty() || member.leases.empty() || member.suspect
            || now - member.head_since < lease_of(member))
            continue;
        member.suspect = true;
        take_back(member, groups_[member.options.group], decisions);
    }
    for (auto& [name, group] : groups_)
        pump_group(name, now, decisions);
    return decisions;
}

bool ReceiverTable::wanted() const noexcept
{
    return std::ranges::any_of(groups_, [](const auto& row) { return row.second.active(); })
           || std::ranges::any_of(receivers_,
                                  [](const auto& row) { return row.second.options.delivery == Delivery::data; });
}

std::int64_t ReceiverTable::group_credit(const std::string& name) const
{
    std::int64_t credit = 0;
    for (const auto& [id, member] : receivers_)
        if (member.options.group == name && !member.suspect)
            credit += member.asked - member.sent;
    return credit;
}

bool ReceiverTable::asked() const
{
    const auto receiver_asks = [](const auto& row) {
        const Receiver& receiver = row.second;
        if (!receiver.counts_for_demand())
            return true;
        return receiver.streaming()
                   ? receiver.waiting.empty()
                   : receiver.asked - receiver.sent > static_cast<std::int64_t>(receiver.waiting.size());
    };
    const auto group_asks = [&](const auto& row) {
        return !row.second.active() || group_credit(row.first) > static_cast<std::int64_t>(row.second.waiting.size());
    };
    return wanted() && std::ranges::all_of(receivers_, receiver_asks) && std::ranges::all_of(groups_, group_asks);
}

bool ReceiverTable::backlogged() const
{
    const auto receiver_waits = [](const auto& row) {
        return row.second.counts_for_demand() && !row.second.waiting.empty() && row.second.waiting.front()->lossless();
    };
    const auto group_waits = [](const auto& row) {
        return !row.second.waiting.empty() && row.second.waiting.front().event->lossless();
    };
    return !held_.empty() || std::ranges::any_of(receivers_, receiver_waits)
           || std::ranges::any_of(groups_, group_waits);
}

bool ReceiverTable::leasing() const
{
    return std::ranges::any_of(receivers_, [](const auto& row) { return !row.second.leases.empty(); });
}

std::vector<ReceiverTable::Row> ReceiverTable::rows() const
{
    std::vector<Row> rows;
    for (const auto& [id, receiver] : receivers_)
        rows.push_back({id, receiver.name, receiver.epoch, receiver.options, receiver.counts});
    for (const auto& [name, group] : groups_) {
        if (!group.active() && group.waiting.empty())
            continue;
        ConnectionOptions options;
        options.group = name;
        rows.push_back({0, "group " + name, 0, options, group.counts});
    }
    return rows;
}

}  // namespace hive::event
