// Both ends of a connection through random steps: a subscription, the inputs of its consumers, and what is under way
// between them, with connections that break, receivers that restart, and members that hand back. Whatever happens, an
// input is never given more than it allows, a plain receiver misses nothing and gets nothing twice that it has
// acknowledged, what must arrive ends with somebody, and nothing stalls.
#include "random_steps.hpp"

#include <hive/event/input_progress.hpp>

#include <map>
#include <set>

namespace hive::event {
namespace {

using namespace random;
using namespace std::chrono_literals;

class HopWalk {
public:
    explicit HopWalk(Dice& dice) : dice_(dice) { begin(); }

    void step()
    {
        const auto kind = dice_.between(1, 1000);
        Peer& peer = *dice_.one_of(peers_);
        if (kind <= 250)
            offer();
        else if (kind <= 500)
            down(peer);
        else if (kind <= 700)
            up(peer);
        else if (kind <= 950)
            process(peer);
        else if (kind <= 970)
            peer.connected ? cut(peer, Fate::lost_connection) : come_back(peer);
        else if (kind <= 975)
            restart(peer);
        else if (kind <= 998)
            pass(std::chrono::milliseconds(dice_.between(1, 2000)));
        else
            end();
    }

    void check() const { hold(balanced(subscription_->ledger()), "the account balances"); }

private:
    struct Work {
        std::int64_t generation, number, sequence;
        bool worked = false;
    };
    struct Peer {
        ReceiverId id = 0;
        bool connected = false;
        InputProgress progress{};
        std::deque<EmissionPtr> down{};
        std::deque<protocol::Request> up{};
        std::vector<Work> works{};
        std::set<std::int64_t> got{};  ///< since it was started, of what must arrive
        Clock::time_point lost_at{};
    };

    void begin()
    {
        shared_ = dice_.yes(50);
        options_ = shared_ ? sharing(500ms, static_cast<int>(dice_.between(1, 3)))
                           : (dice_.yes(30) ? streaming() : window(static_cast<int>(dice_.between(1, 4))));
        subscription_.emplace(Subscription::Kind{.shared_as = shared_ ? "camera.image#workers" : "", .epoch = 1});
        owed_.clear();
        ended_.clear();
        peers_.assign(static_cast<std::size_t>(shared_ ? dice_.between(1, 3) : 1), Peer());
        for (Peer& peer : peers_)
            come_back(peer);
    }

    void offer()
    {
        const auto event = any_emission(dice_, ++sequence_, dice_.yes(70));
        if (event->lossless() && subscription_->active())
            owed_.insert(sequence_);
        decide([&](Decisions& to) { subscription_->offer(event, now_, to); });
    }

    /// The next event arrives.
    void down(Peer& peer)
    {
        if (peer.down.empty())
            return;
        const auto event = std::exchange(peer.down.front(), nullptr);
        peer.down.pop_front();
        hold(peer.progress.allows(event->lossless()), "an input is given no more than it allows");
        const auto number = peer.progress.receive(event->lossless(), 0);
        const auto sequence = sequence_of(event);
        peer.works.push_back({peer.progress.generation(), number, sequence});
        if (event->lossless() && !shared_)
            hold(peer.got.insert(sequence).second, "a plain receiver gets nothing twice that it has");
        const auto id = peer.id;
        decide([&](Decisions& to) { subscription_->written(id, event->size(), now_, to); });
        flush(peer);
    }

    /// The sender hears a request.
    void up(Peer& peer)
    {
        if (peer.up.empty())
            return;
        const auto request = std::move(peer.up.front());
        peer.up.pop_front();
        decide([&](Decisions& to) {
            subscription_->request(peer.id, {request.id, request.worked, request.done}, request.back, now_, to);
        });
    }

    /// Something that it has is processed, acknowledged, or both; a member may hand it back instead.
    void process(Peer& peer)
    {
        if (peer.works.empty())
            return;
        const auto work = dice_.one_of(peer.works);
        const bool back = shared_ && !work->worked && dice_.yes(10);
        const bool done = back || work->worked || dice_.yes(60);
        peer.progress.heard(work->generation, work->number, true, done, back);
        work->worked = true;
        if (done && !back && work->generation == peer.progress.generation())
            ended_.insert(work->sequence);
        if (done)
            peer.works.erase(work);
        flush(peer);
    }
    void flush(Peer& peer)
    {
        if (!peer.connected)
            return;
        if (auto news = peer.progress.news(true))
            peer.up.push_back(std::move(*news));
    }

    void cut(Peer& peer, Fate how)
    {
        peer.down.clear();
        peer.up.clear();
        peer.lost_at = now_;
        if (std::exchange(peer.connected, false))
            decide([&](Decisions& to) { subscription_->detach(peer.id, how, true, now_, to); });
    }
    /// It registers again, and says what it has. Its place is kept while its source waits for it.
    void come_back(Peer& peer)
    {
        if (!subscription_->awaited())
            ++place_;
        const bool knows = !shared_ && peer.progress.place() == place_;
        const auto received = knows ? std::optional(peer.progress.arrived()) : std::nullopt;
        peer.id = ++last_id_;
        peer.connected = true;
        decide([&](Decisions& to) {
            const auto taken = subscription_->attach(peer.id, options_, received, nullptr, now_, to);
            hold(peer.progress.begin(1, options_, shared_ ? 0 : place_, taken) == knows,
                 "who comes back in time goes on where it was");
        });
        flush(peer);
    }
    void restart(Peer& peer)
    {
        cut(peer, Fate::lost_killed);
        peer.works.clear();
        peer.got.clear();
        peer.progress = {};
    }

    void pass(Clock::duration time)
    {
        now_ += time;
        for (Peer& peer : peers_)
            if (!peer.connected && now_ > peer.lost_at + Subscription::kept_for - 5s)
                come_back(peer);
        decide([&](Decisions& to) { subscription_->tick(now_, to); });
    }

    /// Everybody is there and deals with everything.
    void end()
    {
        for (int round = 0; round == 0 || subscription_->ledger().in_flight() > 0; ++round) {
            hold(round < 20'000, "nothing stalls when all deal with what they get");
            for (Peer& peer : peers_) {
                if (!peer.connected)
                    come_back(peer);
                while (!peer.down.empty())
                    down(peer);
                while (!peer.works.empty())
                    process(peer);
                while (!peer.up.empty())
                    up(peer);
            }
            pass(1ms);
        }
        for (const auto sequence : owed_)
            hold(ended_.contains(sequence), "what must arrive ends with somebody, or fails");
        begin();
    }

    template <class Call>
    void decide(Call call)
    {
        const auto decisions = decided(call);
        for (const auto& send : decisions.sends)
            std::ranges::find(peers_, send.receiver, &Peer::id)->down.push_back(send.event);
        for (const auto& event : decisions.failed)
            ended_.insert(sequence_of(event));
    }

    Dice& dice_;
    bool shared_ = false;
    ConnectionOptions options_;
    std::optional<Subscription> subscription_;
    std::vector<Peer> peers_;
    std::set<std::int64_t> owed_, ended_;  ///< what must arrive; what was acknowledged or given up
    Clock::time_point now_ = start;
    ReceiverId last_id_ = 0;
    std::int64_t sequence_ = 0, place_ = 0;
};

}  // namespace

TEST_CASE("hop: two hundred thousand random steps at both ends of a connection break no promise")
{
    walk(200'000, [](Dice& dice) { return HopWalk(dice); });
}

}  // namespace hive::event
