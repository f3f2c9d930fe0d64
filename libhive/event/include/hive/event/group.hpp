// The receivers that share the events of one output: jobs, members, leases, turns that are closed once (SPEC.md,
// section 8).
#pragma once

#include <hive/event/line.hpp>

#include <array>
#include <map>
#include <set>

namespace hive::event {

/// How long the work of a group takes, for its leases.
class WorkTimes {
public:
    void add(Clock::duration time) { recent_[count_++ % recent_.size()] = time; }
    [[nodiscard]] Clock::duration lease() const;

private:
    std::array<Clock::duration, 64> recent_{};
    std::size_t count_ = 0;
};

/// Pure logic. The ledgers belong to the table and outlive it.
class Group {
public:
    static constexpr int most_failures = 3;  ///< members that died over an event or worked on it for too long

    /// @param of      what its shares are called: "camera.image#workers"
    /// @param leases  false: tests show what leases are for
    Group(std::string of, std::int64_t epoch, Ledger& ledger, bool leases)
        : of_(std::move(of)), epoch_(epoch), ledger_(&ledger), leases_(leases)
    {
    }

    void join(ReceiverId id, std::string receiver, std::int64_t epoch, const ConnectionOptions& options, Ledger& ledger,
              Clock::time_point now, Decisions& decisions);
    void request(ReceiverId id, std::int64_t epoch, const Progress& progress, const std::vector<std::int64_t>& back,
                 Clock::time_point now, Decisions& decisions);
    void written(ReceiverId id, std::size_t bytes, Clock::time_point now, Decisions& decisions);
    void offer(const EmissionPtr& event, Clock::time_point now, Decisions& decisions);
    /// Leases may have expired.
    void tick(Clock::time_point now, Decisions& decisions);

    /// The member deregistered: what it has not done goes to others, and nobody is to blame.
    void leave(ReceiverId id, Clock::time_point now, Decisions& decisions);
    /// Its connection ended.
    void lose(ReceiverId id, Fate how, Clock::time_point now, Decisions& decisions);
    /// Nobody waits for the members that were lost any longer; if they were the last, what is left is given up.
    void forget(Decisions& decisions);
    /// Nobody is there, or awaited, who could do what is left. What a lost member may have answered is not told as
    /// failed then, or it would have two answers: it waits for the next member, whoever that is.
    /// @param also_in_doubt  there will be no next member
    void give_up(bool also_in_doubt, Decisions& decisions);

    [[nodiscard]] bool active() const { return !members_.empty() || awaited_; }
    /// Is it without members, and does the source wait for one to come?
    [[nodiscard]] bool awaited() const { return awaited_; }
    [[nodiscard]] bool lost(const std::string& drone) const;
    [[nodiscard]] const std::string& receiver(ReceiverId id) const { return members_.at(id).receiver; }
    /// Have members asked for an event that it has not got?
    [[nodiscard]] bool asks() const;
    /// Do lossless events wait for a member to ask?
    [[nodiscard]] bool backlogged() const;
    [[nodiscard]] bool leasing() const;
    [[nodiscard]] std::int64_t waiting() const { return static_cast<std::int64_t>(again_.size() + fresh_.size()); }
    [[nodiscard]] Reason why() const;
    [[nodiscard]] Reason why(ReceiverId member) const;
    /// Turns given so far, and the last of those that have their answer, as have all before.
    [[nodiscard]] Share standing() const { return {.of = of_, .epoch = epoch_, .turn = turns_, .closed = closed()}; }

private:
    struct Job {  ///< an event that was given out and has no answer yet
        EmissionPtr event;
        int attempt = 0;
        int failures = 0;
        int holders = 0;        ///< connected members that were given it and have not handed it back
        bool in_doubt = false;  ///< a member that was lost had it, and may have answered without telling
    };
    struct Hand {  ///< one delivery to a member
        std::int64_t turn = 0;
        bool passed_on = false;  ///< it went to somebody else meanwhile; its number alone is awaited
    };
    struct Member {
        std::string receiver;
        std::int64_t epoch = 0;
        ConnectionOptions options;
        Ledger* ledger = nullptr;
        Credit credit;
        std::deque<Hand> hands;          ///< in the order of delivery, from done + 1 on
        Clock::time_point head_since{};  ///< when the one being worked on became that
        std::uint64_t asked_at = 0;      ///< order in which members asked
        bool suspect = false;            ///< a lease of it expired: it gets nothing until it answers

        /// What it works on, if anything.
        [[nodiscard]] Hand* head();
        [[nodiscard]] bool holds(std::int64_t turn) const;
        [[nodiscard]] std::size_t unworked() const
        {
            return hands.size() - static_cast<std::size_t>(credit.worked_in_hand());
        }
    };
    using Members = std::map<ReceiverId, Member>;

    void pump(Clock::time_point now, Decisions& decisions);
    Members::iterator choose(std::int64_t turn, std::size_t bytes);
    void give(ReceiverId id, Member& member, std::int64_t turn, Clock::time_point now, Decisions& decisions);
    void acknowledge(Member& member, std::int64_t done);
    void close(std::int64_t turn);
    void pass_on(Member& member, Hand& hand, bool failed, bool holds);
    void let_go(Member& member, Fate how);
    void settle(Decisions& decisions);
    void empty(bool left, Decisions& decisions);
    void abandon(const EmissionPtr& event, const Share& share, Decisions& decisions);
    [[nodiscard]] EmissionPtr next_event() const;
    [[nodiscard]] std::int64_t closed() const { return open_.empty() ? turns_ : open_.begin()->first - 1; }
    [[nodiscard]] Share share(std::int64_t turn, const Job& job) const;
    [[nodiscard]] Clock::duration lease_of(const Member& member) const;

    std::string of_;
    std::int64_t epoch_;
    Ledger* ledger_;
    bool leases_;
    Members members_;
    std::map<std::int64_t, Job> open_;  ///< by turn
    std::set<std::int64_t> again_;      ///< turns that wait to be given out once more
    std::deque<EmissionPtr> fresh_;     ///< without turn yet
    std::int64_t turns_ = 0;
    WorkTimes times_;
    bool awaited_ = false;   ///< its last member was lost with work on demand, so the source waits for the next one
    bool lossless_ = false;  ///< the last event offered was
    std::set<std::string> lost_;
    std::uint64_t asking_order_ = 0;
};

}  // namespace hive::event
