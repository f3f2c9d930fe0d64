// One subscription after another through random steps, and what is promised of each whatever its mechanism: deliveries
// are numbered without gaps, none is given to a consumer that has it, no event fails twice or fails and is answered,
// none that must arrive vanishes, and everything ends.
#include "random_steps.hpp"

#include <map>
#include <set>

namespace hive::event {
namespace {

using namespace random;
using namespace std::chrono_literals;

class SubscriptionWalk {
public:
    explicit SubscriptionWalk(Dice& dice) : dice_(dice) { begin(); }

    void step()
    {
        const auto kind = dice_.between(1, 1000);
        if (kind <= 350)
            offer();
        else if (kind <= 900 && !peers_.empty())
            kind <= 650 ? report(*dice_.one_of(peers_)) : write(dice_.one_of(peers_)->first);
        else if (kind <= 940 && (peers_.empty() || (shared_ && peers_.size() < 6)))
            attach();
        else if (kind <= 965 && !peers_.empty())
            detach();
        else if (kind <= 990)
            pass(std::chrono::milliseconds(dice_.between(1, 3000)));
        else if (kind <= 992)
            cancel();
        else if (kind <= 994)
            regroup();
        else
            decide([&](Decisions& to) { subscription_->end(now_, to); });
        if (++steps_ % 2000 == 0) {
            rest();
            begin();
        }
    }

    void check() const
    {
        const Ledger& ledger = subscription_->ledger();
        hold(balanced(ledger), "offered = ended + in flight");
        for (const auto& [number, member] : members_)
            hold(balanced(member.own.ledger), "a member's deliveries are accounted for");
        hold(subscription_->waiting() <= ledger.in_flight(), "what waits is in flight");
        hold(!subscription_->backlogged() || subscription_->has_waiting(), "a backlog waits");
    }

private:
    struct Peer {
        ConnectionOptions options{};
        Progress told{};
        std::int64_t sent = 0, newest = 0;
        std::int64_t came_at = 0;                    ///< the sequence that was offered last by then
        std::map<std::int64_t, std::int64_t> has{};  ///< sequence by number; not acknowledged, and not returned
        Lane lane{};
        bool told_end = false;
        Subscription::Member* own = nullptr;
    };
    struct Member {
        Subscription::Member own{};
        std::optional<Peer> away{};
    };

    void begin()
    {
        shared_ = dice_.yes(50);
        streams_ = !shared_ && dice_.yes(40);
        passive_ = !shared_ && dice_.yes(15);
        subscription_.emplace(kind());
        regrouped_ = false;
        peers_.clear();
        away_.reset();
        members_.clear();
        owed_.clear();
        answered_.clear();
        failed_.clear();
        deaths_.clear();
        live_.clear();
    }

    [[nodiscard]] Subscription::Kind kind() const
    {
        return {.shared_as = shared_ ? "camera.image#workers" : "", .epoch = 1, .passive = passive_};
    }

    void offer()
    {
        const bool lossless = dice_.yes(60);
        const auto before = subscription_->ledger().total(), missed = subscription_->missed().count;
        const auto event = any_emission(dice_, ++sequence_, lossless);
        if (!lossless || passive_)
            live_.insert(sequence_);
        for (auto& [id, peer] : peers_)
            peer.told_end = false;
        const bool was_missing = subscription_->missing();
        decide([&](Decisions& to) { subscription_->offer(event, now_, to); });
        const bool misses = subscription_->missed().count > missed;
        hold(misses == (was_missing && lossless && !passive_), "who was away for too long misses what must arrive");
        if (lossless && !passive_ && subscription_->ledger().total() > before && !misses)
            owed_.insert(sequence_);
        look();
    }

    void report(std::pair<const ReceiverId, Peer>& row)
    {
        auto& [id, peer] = row;
        const auto progress = any_progress(dice_, peer.told, peer.sent, peer.options.window);
        std::vector<std::int64_t> returned;
        if (shared_ && dice_.yes(10))
            returned.push_back(dice_.between(1, peer.sent + 1));
        tell(id, progress, returned);
    }
    void tell(ReceiverId id, const Progress& progress, const std::vector<std::int64_t>& returned)
    {
        Peer& peer = peers_.at(id);
        for (const auto number : returned)
            peer.has.erase(number);
        take_over(peer.told, progress, peer.sent, peer.options.window);
        while (!peer.has.empty() && peer.has.begin()->first <= peer.told.done) {
            const auto sequence = peer.has.begin()->second;
            hold(!failed_.contains(sequence), "what is answered did not fail");
            answered_.insert(sequence);
            peer.has.erase(peer.has.begin());
        }
        decide([&](Decisions& to) { subscription_->request(id, progress, returned, now_, to); });
    }

    void write(ReceiverId id)
    {
        if (Peer& peer = peers_.at(id); !peer.lane.empty()) {
            const auto bytes = peer.lane.written();
            decide([&](Decisions& to) { subscription_->written(id, bytes, now_, to); });
        }
    }

    /// Back with what it has, back as a new process, or for the first time.
    void attach()
    {
        Peer peer;
        peer.options = streams_ ? streaming() : window(static_cast<int>(dice_.between(1, 4)));
        if (shared_)
            peer.options.lease = 500ms;
        std::optional<std::int64_t> received;
        Member* member = shared_ ? &any_member() : nullptr;
        peer.own = member ? &member->own : nullptr;
        auto& away = member ? member->away : away_;
        if (away) {
            const bool resumes = dice_.yes(50);
            if (resumes) {
                received = dice_.between(away->told.done, away->sent);
                deaths_.clear();  // it was silent, not dead
                peer.has = away->has;
                peer.has.erase(peer.has.upper_bound(*received), peer.has.end());
            }
            if (resumes || !shared_) {
                peer.told.done = away->told.done;
                peer.sent = received.value_or(away->told.done);
                peer.told.worked = std::min(away->told.worked, peer.sent);
            }
        }
        peer.told.asked = peer.sent + peer.options.window;
        peer.came_at = sequence_;
        away.reset();
        const auto id = ++last_id_;
        const auto continues_behind = peer.sent;
        const auto options = peer.options;
        auto* const own = peer.own;
        peers_[id] = std::move(peer);
        std::int64_t behind = 0;
        decide([&](Decisions& to) { behind = subscription_->attach(id, options, {received}, own, now_, to); });
        hold(behind == continues_behind, "deliveries continue behind what the receiver knows of");
    }

    /// One that is not attached.
    Member& any_member()
    {
        for (;;)
            if (Member& one = members_[dice_.between(1, 7)];
                std::ranges::none_of(peers_, [&](auto& row) { return row.second.own == &one.own; }))
                return one;
    }

    void forget_away(Member& member)
    {
        member.away.reset();
        decide([&](Decisions& to) { subscription_->forget_away(member.own, now_, to); });
    }

    void detach()
    {
        const auto found = dice_.one_of(peers_);
        const auto id = found->first;
        const Peer peer = std::move(found->second);
        peers_.erase(found);
        const auto how = dice_.yes(25) ? Fate::lost_left : any_loss(dice_);
        const bool left = how == Fate::lost_left, last = peers_.empty();
        const bool returns = dice_.yes(left ? 50 : 90) && (shared_ || !left);
        if (last && left && !returns)
            owed_.clear();
        excused_ = !returns;
        lost_at_ = now_;
        const auto head = peer.has.find(peer.told.worked + 1);
        if (!shared_ && head != peer.has.end() && how != Fate::lost_connection)
            ++deaths_[head->second];
        decide([&](Decisions& to) { subscription_->detach(id, how, returns, now_, to); });
        if (last && !shared_ && subscription_->awaited())
            away_ = peer;
        for (auto& [number, member] : members_)
            if (&member.own == peer.own && member.own.away)
                member.away = peer;
        look();
    }

    void pass(Clock::duration time)
    {
        now_ += time;
        decide([&](Decisions& to) { subscription_->tick(now_, to); });
        if (shared_ && dice_.yes(10))
            forget_away(any_member());
        look();
    }

    void cancel()
    {
        if (peers_.empty())
            owed_.clear();
        decide([&](Decisions& to) { subscription_->cancel(to); });
        look();
    }

    /// The consumers are gone, and what they had or waited for goes to another kind of subscription.
    void regroup()
    {
        if (passive_)
            return;
        while (!peers_.empty()) {
            const auto id = peers_.begin()->first;
            peers_.erase(peers_.begin());
            decide([&](Decisions& to) { subscription_->detach(id, Fate::lost_connection, true, now_, to); });
        }
        for (auto& [number, member] : members_)
            forget_away(member);
        members_.clear();
        shared_ = !shared_;
        streams_ = streams_ && !shared_;
        regrouped_ = true;
        away_.reset();
        Subscription other(kind());
        decide([&](Decisions& to) { other.adopt(std::move(*subscription_), false, now_, to); });
        hold(subscription_->ledger().in_flight() == 0, "all of it goes along");
        subscription_.emplace(std::move(other));
        attach();
    }

    /// A source waits for the only receiver of what must arrive: for 30 s, if that may come back.
    void look()
    {
        if (shared_ || !peers_.empty() || subscription_->awaited())
            return;
        const bool over = excused_ || now_ >= lost_at_ + Subscription::kept_for;
        hold(over || std::ranges::all_of(owed_, [this](auto sequence) { return ended(sequence); }),
             "a source waits for a receiver that may come back");
        away_.reset();
        owed_.clear();
    }
    [[nodiscard]] bool ended(std::int64_t sequence) const
    {
        return answered_.contains(sequence) || failed_.contains(sequence);
    }

    /// There is a consumer, and all deal with everything.
    void rest()
    {
        if (peers_.empty())
            attach();
        for (auto& [number, member] : members_)
            forget_away(member);
        for (int round = 0; round == 0 || subscription_->ledger().in_flight() > 0; ++round) {
            hold(round < 20'000, "everything ends when all deal with what they get");
            for (auto it = peers_.begin(); it != peers_.end(); ++it) {
                while (!it->second.lane.empty())
                    write(it->first);
                const auto sent = it->second.sent;
                tell(it->first, {sent + it->second.options.window, sent, sent}, {});
            }
        }
        for (const auto sequence : owed_)
            hold(ended(sequence), "nothing that must arrive vanishes");
        decide([&](Decisions& to) { subscription_->end(now_, to); });
        for (const auto& [id, peer] : peers_)
            hold(peer.told_end, "each consumer hears of the end");
        hold(!subscription_->backlogged() && (subscription_->asks() || streams_),
             "in the end there is nothing but demand");
    }

    template <class Call>
    void decide(Call call)
    {
        const auto decisions = decided(call);
        for (const auto& send : decisions.sends)
            sent(send);
        for (const auto& event : decisions.failed) {
            hold(!answered_.contains(sequence_of(event)), "what failed was not answered");
            hold(failed_.insert(sequence_of(event)).second, "nothing fails twice");
        }
        for (const auto id : decisions.ends) {
            hold(!subscription_->has_waiting(), "the end comes behind what waits");
            hold(!std::exchange(peers_.at(id).told_end, true), "the end comes once");
        }
    }
    void sent(const Send& send)
    {
        hold(peers_.contains(send.receiver), "only consumers that are there are sent something");
        Peer& peer = peers_.at(send.receiver);
        const auto sequence = sequence_of(send.event);
        for (const auto& [number, has] : peer.has)
            hold(has != sequence, "no consumer is given what it has");
        hold(!answered_.contains(sequence) || !send.event->lossless() || shared_, "what is answered is not sent again");
        hold(deaths_[sequence] < Subscription::max_failures, "nothing is given out again over which three have died");
        if (!shared_ && !regrouped_) {
            hold(sequence > std::exchange(peer.newest, sequence), "a receiver gets events in their order");
            const bool live = passive_ || !send.event->lossless();
            hold(!live || sequence > peer.came_at, "what is live is not kept for a receiver that is away");
            hold(!live || streams_ || !live_.contains(sequence + 1), "of what is live a receiver gets the newest");
        }
        peer.has[++peer.sent] = sequence;
        peer.lane.sent(send.event->size());
        if (!streams_)
            hold(peer.sent <= peer.told.asked, "no consumer is sent more than it asked for");
        else if (send.event->lossless() && !passive_)
            hold(peer.sent - peer.told.worked <= Credit::most_streamed, "64 of a stream are unprocessed at most");
    }

    Dice& dice_;
    bool shared_ = false, streams_ = false, passive_ = false, regrouped_ = false;
    std::optional<Subscription> subscription_;
    Clock::time_point now_ = start;
    std::map<ReceiverId, Peer> peers_;
    std::optional<Peer> away_;  ///< as it remembers itself
    std::map<std::int64_t, Member> members_;
    bool excused_ = false;
    Clock::time_point lost_at_{};
    std::set<std::int64_t> live_, owed_, answered_, failed_;
    std::map<std::int64_t, int> deaths_;
    ReceiverId last_id_ = 0;
    std::int64_t sequence_ = 0;
    std::uint64_t steps_ = 0;
};

}  // namespace

TEST_CASE("subscription: two hundred thousand random steps break no promise")
{
    walk(200'000, [](Dice& dice) { return SubscriptionWalk(dice); });
}

}  // namespace hive::event
