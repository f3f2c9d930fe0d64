// A group through random steps, beside simple books of who holds which turn and what must have become of it.
#include "random_steps.hpp"

namespace hive::event {
namespace {

using namespace random;

class GroupWalk {
public:
    explicit GroupWalk(Dice& dice) : dice_(dice), group_("camera.image#workers", 1, ledger_, true) {}

    void step()
    {
        const auto kind = dice_.between(1, 100);
        if (kind <= 35)
            offer();
        else if (members_.empty() && kind <= 90)
            join();
        else if (kind <= 65 && !members_.empty())
            ask();
        else if (kind <= 90 && !members_.empty())
            write();
        else if (kind <= 93)
            pass();
        else if (kind <= 96)
            join();
        else if (!members_.empty())
            kind <= 98 ? lose() : leave();
        else if (dice_.yes(10))
            forget();
    }

    void check() const
    {
        hold(balanced(ledger_), "the ledger balances");
        hold(ledger_ == books_, "each event has the fate that it must have");
        hold(ledger_.in_flight() == std::ssize(open_) + std::ssize(fresh_),
             "in flight is what was given out and what waits");
        hold(group_.awaited() == awaited_, "who is waited for");
        std::int64_t waiting = std::ssize(fresh_);
        for (const auto& [turn, job] : open_) {
            hold(job.waits || !job.holders.empty(), "a turn that nobody can answer has ended");
            waiting += job.waits ? 1 : 0;
        }
        hold(group_.waiting() == waiting, "what waits is what waits");
        hold(group_.standing().turn == turns_ && group_.standing().closed == closed(),
             "the turns are told as they are");
        check_members();
        check_pace();
    }

private:
    struct Job {
        EmissionPtr event;
        int attempts = 0, failures = 0;
        bool waits = false;            ///< to be given out again
        bool in_doubt = false;         ///< who was lost may have answered
        std::set<ReceiverId> holders;  ///< who may answer
    };
    struct Hand {
        std::int64_t turn = 0;
        bool handed_back = false, passed_on = false;
    };
    struct Member {
        std::string name;
        std::int64_t registration = 0;
        ConnectionOptions options;
        Progress known;
        Lane lane;
        std::deque<Hand> hands;  ///< not done
        std::int64_t sent = 0;
        bool suspect = false;
        Clock::time_point head_since{};

        [[nodiscard]] std::size_t worked() const { return static_cast<std::size_t>(known.worked - known.done); }
        [[nodiscard]] bool works() const { return worked() < hands.size(); }
    };

    void check_members() const
    {
        std::map<std::string, std::int64_t> in_hand;
        for (const auto& [id, member] : members_) {
            for (const auto& hand : member.hands)
                in_hand[member.name] += hand.passed_on ? 0 : 1;
        }
        for (const auto& [name, account] : accounts_) {
            hold(balanced(account), "the ledgers of the members balance");
            const auto found = in_hand.find(name);
            hold(account.in_flight() == (found == in_hand.end() ? 0 : found->second),
                 "in flight to a member is what is in its hand and nobody else's");
        }
    }

    /// In their order, older turns first; only those whom everybody with credit has in hand wait for somebody else.
    void check_pace() const
    {
        std::vector<std::pair<EmissionPtr, std::set<ReceiverId>>> waiting;
        for (const auto& [turn, job] : open_)
            if (job.waits)
                waiting.emplace_back(job.event, job.holders);
        if (!fresh_.empty())
            waiting.emplace_back(fresh_.front(), std::set<ReceiverId>{});
        for (const auto& [event, holders] : waiting) {
            bool somebody = false;
            for (const auto& [id, member] : members_)
                if (!member.suspect && member.sent < member.known.asked && !holders.contains(id)) {
                    hold(!member.lane.free(event->size()), "nothing stands still");
                    somebody = true;
                }
            if (somebody)
                return;  // it goes when a lane is free, before what is behind it
        }
    }

    void offer()
    {
        const bool lossless = dice_.yes(60);
        const auto event = any_emission(dice_, ++sequence_, lossless);
        if (!group_.active() && !dice_.yes(10))
            return;  // the table offers it nothing
        books_.came();
        last_was_lossless_ = lossless;
        if (!lossless && !fresh_.empty() && !fresh_.back()->lossless()) {
            fresh_.pop_back();
            books_.went(Fate::skipped);
        }
        fresh_.push_back(event);
        decide([&](Decisions& to) { group_.offer(event, now_, to); });
    }

    void join()
    {
        if (members_.size() >= 6)
            return;
        ConnectionOptions options = sharing(lease, static_cast<int>(dice_.between(1, 4)));
        const auto id = ++last_id_;
        Member& member = members_[id];
        member.name = "face-" + std::to_string(dice_.between(1, 8));
        member.registration = static_cast<std::int64_t>(id) + 100;
        member.options = options;
        member.known.asked = options.window;
        awaited_ = false;
        decide([&](Decisions& to) {
            group_.join(id, member.name, member.registration, options, accounts_[member.name], now_, to);
        });
    }

    void ask()
    {
        auto& [id, member] = *dice_.one_of(members_);
        const auto told = any_progress(dice_, member.known, member.sent, member.options.window);
        std::vector<std::int64_t> back;
        for (auto number = told.worked + 1; number <= member.sent && dice_.yes(10); ++number)
            back.push_back(number);
        if (dice_.yes(3))
            back.push_back(dice_.between(-3, member.sent + 9));
        const bool stale = dice_.yes(3);
        if (!stale) {
            for (const auto number : back)
                hand_back(id, member, number);
            hear(id, member, told);
            end_hopeless();
        }
        decide([&, to_member = id, registration = member.registration - (stale ? 1 : 0)](Decisions& to) {
            group_.request(to_member, registration, told, back, now_, to);
        });
    }

    void hand_back(ReceiverId id, Member& member, std::int64_t number)
    {
        if (number <= member.known.done || number > member.sent)
            return;
        Hand& hand = member.hands[static_cast<std::size_t>(number - member.known.done - 1)];
        if (!std::exchange(hand.handed_back, true))
            let_go(id, hand, false, false);
    }

    void hear(ReceiverId id, Member& member, const Progress& told)
    {
        const auto before = member.known;
        take_over(member.known, told, member.sent, member.options.window);
        if (member.known.worked > before.worked) {
            member.suspect = false;
            member.head_since = now_;
        }
        for (auto done = before.done; done < member.known.done; ++done) {
            const Hand hand = member.hands.front();
            member.hands.pop_front();
            if (!hand.handed_back && open_.contains(hand.turn)) {
                hold(open_.at(hand.turn).holders.contains(id), "who answers holds the turn");
                open_.erase(hand.turn);
                books_.went(Fate::acknowledged);
            }
        }
    }

    /// @param holds  it may answer all the same
    void let_go(ReceiverId id, Hand& hand, bool failed, bool holds)
    {
        const bool first = !std::exchange(hand.passed_on, true);
        const auto found = open_.find(hand.turn);
        if (found == open_.end())
            return;
        Job& job = found->second;
        job.failures += failed ? 1 : 0;
        if (!holds)
            job.holders.erase(id);
        job.waits = job.waits || (first && job.failures < Group::most_failures);
    }

    /// What nobody holds and nobody is to do again must be told as failed.
    void end_hopeless()
    {
        std::erase_if(open_, [&](const auto& row) {
            const bool over = !row.second.waits && row.second.holders.empty();
            if (over)
                expect_failure(row.second.event);
            return over;
        });
    }
    void expect_failure(const EmissionPtr& event)
    {
        books_.went(Fate::abandoned);
        expected_failures_.push_back(sequence_of(event));
    }

    void write()
    {
        auto& [id, member] = *dice_.one_of(members_);
        if (member.lane.empty())
            return;
        const auto bytes = member.lane.written();
        decide([&, to_member = id](Decisions& to) { group_.written(to_member, bytes, now_, to); });
    }

    void pass()
    {
        now_ += std::chrono::milliseconds(dice_.between(1, 700));
        for (auto& [id, member] : members_)
            if (!member.suspect && member.works() && now_ - member.head_since >= lease) {
                member.suspect = true;
                for (auto i = member.worked(); i < member.hands.size(); ++i)
                    if (!member.hands[i].passed_on)
                        let_go(id, member.hands[i], i == member.worked(), true);
            }
        end_hopeless();
        decide([&](Decisions& to) { group_.tick(now_, to); });
    }

    void lose()
    {
        const auto how = any_loss(dice_);
        go(how != Fate::lost_connection, false, [&](ReceiverId id, Decisions& to) { group_.lose(id, how, now_, to); });
    }
    void leave()
    {
        go(false, true, [&](ReceiverId id, Decisions& to) { group_.leave(id, now_, to); });
    }
    template <class Call>
    void go(bool died, bool left, Call call)
    {
        const auto found = dice_.one_of(members_);
        const auto id = found->first;
        Member member = std::move(found->second);
        members_.erase(found);
        for (auto i = std::size_t{0}; i < member.hands.size(); ++i) {
            if (member.hands[i].handed_back)
                continue;
            if (const auto found_job = open_.find(member.hands[i].turn); found_job != open_.end() && !left)
                found_job->second.in_doubt = true;
            let_go(id, member.hands[i], died && i == member.worked() && !member.hands[i].passed_on, false);
        }
        if (members_.empty())
            empty(left);
        end_hopeless();
        decide([&](Decisions& to) { call(id, to); });
    }

    void empty(bool left)
    {
        if (!fresh_.empty() && !fresh_.back()->lossless()) {
            fresh_.pop_back();
            books_.went(Fate::skipped);
        }
        if (left)
            return give_up();
        const auto lossless = [](const auto& row) { return row.second.event->lossless(); };
        awaited_ = last_was_lossless_ || !fresh_.empty() || std::ranges::any_of(open_, lossless);
    }

    void forget()
    {
        awaited_ = false;
        give_up();
        decide([&](Decisions& to) { group_.forget(to); });
    }

    void give_up()
    {
        std::erase_if(open_, [&](const auto& row) {
            if (!row.second.in_doubt)
                expect_failure(row.second.event);
            return !row.second.in_doubt;
        });
        for (const auto& event : std::exchange(fresh_, {}))
            expect_failure(event);
    }

    template <class Call>
    void decide(Call call)
    {
        const auto decisions = decided(call);
        auto failed = std::exchange(expected_failures_, {});
        std::ranges::sort(failed);
        Sequences told;
        for (const auto& event : decisions.failed)
            told.push_back(sequence_of(event));
        std::ranges::sort(told);
        hold(told == failed, "given up is what nobody can answer any more, and nothing else");
        for (const auto& send : decisions.sends)
            sent(send);
    }

    void sent(const Send& send)
    {
        hold(members_.contains(send.receiver), "only members are sent something");
        Member& member = members_.at(send.receiver);
        hold(!member.suspect, "who is too slow gets nothing more until it answers");
        hold(member.sent < member.known.asked, "nobody is sent more than it asked for");
        hold(send.share.has_value(), "a member is told the turn");
        const auto turn = send.share->turn;
        if (turn > turns_) {
            hold(turn == turns_ + 1, "turns have no gap");
            hold(!fresh_.empty() && fresh_.front() == send.event, "new events go out in their order, each once");
            fresh_.pop_front();
            open_[++turns_].event = send.event;
        } else {
            hold(open_.contains(turn), "what has ended is not given out again");
            hold(open_.at(turn).waits, "only what waits is given out again");
            hold(!open_.at(turn).holders.contains(send.receiver), "nobody is sent a turn that it holds");
        }
        Job& job = open_.at(turn);
        job.waits = false;
        hold(send.share->attempt == ++job.attempts, "attempts are counted");
        hold(send.share->closed <= closed(), "what is told to be closed is");
        job.holders.insert(send.receiver);
        if (!member.works())
            member.head_since = now_;
        member.lane.sent(send.event->size());
        ++member.sent;
        member.hands.push_back({turn});
    }

    [[nodiscard]] std::int64_t closed() const { return open_.empty() ? turns_ : open_.begin()->first - 1; }

    static constexpr std::chrono::milliseconds lease{500};
    Dice& dice_;
    Ledger ledger_, books_;
    std::map<std::string, Ledger> accounts_;
    Group group_;
    Clock::time_point now_ = start;
    std::map<ReceiverId, Member> members_;
    std::map<std::int64_t, Job> open_;
    std::deque<EmissionPtr> fresh_;
    ReceiverId last_id_ = 0;
    std::int64_t sequence_ = 0, turns_ = 0;
    bool awaited_ = false, last_was_lossless_ = false;
    Sequences expected_failures_;
};

}  // namespace

TEST_CASE("group: a hundred thousand random steps break no promise")
{
    walk(100'000, [](Dice& dice) { return GroupWalk(dice); });
}

}  // namespace hive::event
