// The events of one output for one receiver, or for several receivers that share them: the waiting ones, those of each
// consumer, and the outcome of each.
//
// States. A subscription is *present* while it has a consumer, *awaited* while it has none and its source waits for
// one to return, and otherwise *dormant*: a record that continues counting when a consumer attaches again.
//
//                 attach                      detach: connection lost, something must arrive
//     dormant ------------> present ------------------------------------------------------> awaited
//        ^                   |   ^                                                             |  |
//        |  detach: left, or |   +------------------------- attach ----------------------------+  |
//        +-------------------+                                                                    |
//        +------------------- cancel, or 30 s for a subscription that is not shared --------------+
//
// If an earlier run of the drone had a consumer, the new subscription is awaited from the beginning (expect).
//
// Events. An event waits (`fresh_`) until a consumer may have it; then it is a job with a number (`open_`) until one
// consumer acknowledges it. It counts in the ledger once when it is offered and once when it ends, so
// offered = ended + waiting + open, always. A requeued job is in `again_` as well, and is sent before fresh events, in
// the order of its number.
//
// Which events are requeued. A lossless one always, unless the subscription is passive; a live one only if it is
// shared, where another consumer can still do it in time. Any other live event is kept only to show what a consumer
// failed at.
//
// The three departures of a consumer (detach):
//   left   it deregistered and has acknowledged all that it will. If it was the last, what is left ends, unless the
//          subscription is shared and another one that was lost may return.
//   lost   its connection ended; it may have processed its deliveries. It may return within 30 s, report how much it
//          received, and resume there. Shared: its jobs are requeued meanwhile, and the first answer counts. If it does
//          not resume, it may have answered, so such a job (`in_doubt`) is not reported as failed as long as another
//          consumer may attach.
//   died   as lost, and the job that it was processing has failed once: after three failures no consumer gets it.
//
// Pure logic: the caller holds the loop and passes in time and events; each call appends its decisions to `Decisions`.
// Only the time of a loss is read from the wall clock, for people.
#pragma once

#include <hive/event/clock.hpp>
#include <hive/event/credit.hpp>
#include <hive/event/decisions.hpp>
#include <hive/status.hpp>

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace hive::event {

class Subscription {
public:
    static constexpr int max_failures = 3;
    static constexpr int max_attempt = 1 << 20;  ///< the count stays there, because readers refuse larger ones
    static constexpr auto kept_for = std::chrono::seconds(30);
    static constexpr std::size_t max_queued_events = 1024;     ///< of a stream, when they are small
    static constexpr std::size_t max_queued_bytes = 1u << 20;  ///< of a stream, beyond two events
    /// Of live events that were sent and not acknowledged: how many a consumer's death can be traced to.
    static constexpr std::size_t max_shown_events = 64, max_shown_bytes = 32u << 20;
    /// A stream that has been behind for this long is too slow: then at most two events and 64 KiB are queued.
    static constexpr auto max_behind = std::chrono::milliseconds(500);

    struct Kind {
        std::string shared_as = {};  ///< "camera.image#workers"; empty: one consumer, which gets all events
        std::string receiver = {};   ///< if it is not shared: "face.image"
        std::int64_t epoch = 0;      ///< of the module
        bool passive = false;        ///< the source waits for none of its consumers
        /// Count live events, too, that a disconnected application misses within 30 s.
        bool application = false;
        std::int64_t earlier_jobs = 0;  ///< of a forgotten subscription of this name, in this run
        bool redelivers = true;         ///< false in tests that show the purpose of redelivery
    };
    /// Lossless events that an absent consumer missed, in the last run of their source.
    struct Missed {
        std::int64_t count = 0;
        std::string source = {};  ///< of the last one
        std::int64_t epoch = 0;   ///< of that source

        bool operator==(const Missed&) const = default;
    };
    /// The state of a consumer when it attaches.
    struct Kept {
        std::optional<std::int64_t> received = {};  ///< deliveries received here, if it returns; empty: it restarted
        std::int64_t held = 0;                      ///< unprocessed deliveries of any subscription
    };
    struct Member;
    explicit Subscription(Kind kind) : kind_(std::move(kind)), jobs_(kind_.earlier_jobs) {}

    void offer(const EmissionPtr& event, Clock::time_point now, Decisions& decisions);
    /// A subscription that is not shared replaces its present consumer.
    /// @param own  the record of this consumer of a shared subscription; outlives it
    /// @return the number after which its deliveries continue
    std::int64_t attach(ReceiverId id, const ConnectionOptions& options, const Kept& kept, Member* own,
                        Clock::time_point now, Decisions& decisions);
    /// @param returned  numbers of deliveries to requeue
    void request(ReceiverId id, const Progress& progress, const std::vector<std::int64_t>& returned,
                 Clock::time_point now, Decisions& decisions);
    /// The connection has written an event.
    void written(ReceiverId id, std::size_t bytes, Clock::time_point now, Decisions& decisions);
    /// @param how      one of Fate::lost_...
    /// @param returns  it may return; if it left a shared subscription: another one that was lost may return
    void detach(ReceiverId id, Fate how, bool returns, Clock::time_point now, Decisions& decisions);
    /// This consumer, which lost its connection, will not resume.
    void forget_away(Member& member, Clock::time_point now, Decisions& decisions);
    /// Is it there, or did it lose its connection not long ago?
    [[nodiscard]] bool may_resume(const Member& member) const;
    /// The consumer gets nothing more; it still acknowledges its deliveries, and then leaves.
    void retire(ReceiverId id) { consumers_.at(id).retired = true; }
    /// Moves the waiting events of another subscription, which will have no consumer, to this one.
    /// @param left  its last consumer has deregistered, so it answers nothing more
    void adopt(Subscription&& other, bool left, Clock::time_point now, Decisions& decisions);
    /// The source stops waiting for a consumer, and stops counting its missed events.
    void cancel(Decisions& decisions);
    /// Its consumer was absent for too long: waiting events are lost, and further missed ones are counted.
    void stop_waiting();
    /// For a new subscription: an earlier run of this drone had a consumer, which will return.
    /// @param until  empty: no limit; those of a group are in the ReceiverTable
    void expect(std::optional<Clock::time_point> until, Missed missed);
    /// For a new subscription: an earlier run of this drone had already stopped waiting for the consumer.
    void go_on_missing(Missed missed);
    /// No consumer will attach: gives up all events, even those that a lost consumer may have answered.
    void give_up(Decisions& decisions) { give_up(true, decisions); }
    /// Nothing more will come: each consumer gets the end after the waiting events, and in a shared subscription after
    /// the last acknowledgement.
    void end(Clock::time_point now, Decisions& decisions);
    /// Something may come again: revokes the end at its consumers.
    void go_on(Decisions& decisions);
    /// Has this consumer got the end, and does it still hold?
    [[nodiscard]] bool told_end(ReceiverId id) const;
    /// Handles expired leases, and the end of the 30 s.
    void tick(Clock::time_point now, Decisions& decisions);

    [[nodiscard]] bool shared() const noexcept { return !kind_.shared_as.empty(); }
    [[nodiscard]] bool attached() const noexcept { return !consumers_.empty(); }
    /// Is there a consumer that may get an event?
    [[nodiscard]] bool present() const noexcept
    {
        return std::ranges::any_of(consumers_, [](const auto& row) { return !row.second.retired; });
    }
    [[nodiscard]] bool retiring() const noexcept;
    [[nodiscard]] bool awaited() const noexcept { return awaited_; }
    /// Does the source wait for a consumer?
    [[nodiscard]] bool active() const noexcept { return (present() && !kind_.passive) || awaited_; }
    [[nodiscard]] bool passive() const noexcept { return kind_.passive; }
    void set_passive(bool passive) { kind_.passive = passive; }
    /// Have its consumers requested an event that they have not got?
    [[nodiscard]] bool asks() const;
    /// Does a lossless event wait?
    [[nodiscard]] bool backlogged() const;
    /// Does tick() have to be called?
    [[nodiscard]] bool timed() const;
    [[nodiscard]] std::int64_t waiting() const { return static_cast<std::int64_t>(again_.size() + fresh_.size()); }
    [[nodiscard]] bool has_waiting() const { return waiting() > 0; }
    [[nodiscard]] Reason why() const;
    [[nodiscard]] Reason why(ReceiverId consumer) const;
    [[nodiscard]] const Ledger& ledger() const noexcept { return ledger_; }
    /// Wall clock of the newest loss (is_loss); 0: none.
    [[nodiscard]] std::int64_t last_lost_us() const noexcept { return last_lost_us_; }
    /// True while the consumer is absent and may return, but the source does not wait: its lossless events are lost.
    [[nodiscard]] bool missing() const noexcept { return missing_as_.has_value(); }
    [[nodiscard]] const Missed& missed() const noexcept { return missed_; }
    /// Must the next run of this drone know it, although the source does not wait?
    [[nodiscard]] bool misses_lossless() const { return missing() && lossless_.value_or(true); }
    /// If shared: the number of jobs so far, and the job up to which all are answered.
    [[nodiscard]] Share standing() const;

private:
    struct Job {
        EmissionPtr event;  ///< null: a live event, which is never sent again
        int attempt = 0;
        int failures = 0;
        int holders = 0;        ///< consumers that have not returned it, and may still answer
        bool in_doubt = false;  ///< a lost consumer may have answered it
        std::optional<Share> adopted_as =
            {};  ///< how it was given out elsewhere: an answer to that stands for this one
    };
    struct Handed {  ///< one delivery to a consumer
        std::int64_t job = 0;
        bool passed_on = false;  ///< it was requeued; only the acknowledgement of its number is awaited
        bool lost = false;       ///< because the connection was lost
        EmissionPtr live{};      ///< a live event, kept as long as it may crash the consumer
    };
    struct Consumer {
        ConnectionOptions options;
        Member* own;
        Credit credit;
        std::deque<Handed> hands{};      ///< not acknowledged, in the order of delivery
        Clock::time_point head_since{};  ///< since when the first unprocessed one has been the first
        std::uint64_t asked_at = 0;      ///< order of the consumers' requests
        bool suspect = false;            ///< its lease expired: it gets nothing until it has processed an event
        bool told_end = false;
        bool retired = false;

        [[nodiscard]] std::size_t head() const { return static_cast<std::size_t>(credit.worked_in_hand()); }
        [[nodiscard]] bool works() const { return head() < hands.size(); }
        [[nodiscard]] bool has(std::int64_t job) const;
    };
    struct Away {
        Consumer was;
        Fate how;
        Clock::time_point since{};
        std::int64_t failed = 0;  ///< the job that counts as one it died of
    };
    using Consumers = std::map<ReceiverId, Consumer>;

    [[nodiscard]] bool must_arrive(const EmissionPtr& event) const { return event->lossless() && !kind_.passive; }
    [[nodiscard]] bool comes_back(const Job& job) const;
    [[nodiscard]] bool streams() const;
    [[nodiscard]] bool worth_keeping() const;
    void for_lossless(const std::function<void(const EmissionPtr&)>& call) const;
    [[nodiscard]] bool must_something_arrive() const;
    [[nodiscard]] Share share(std::int64_t number, const Job& job) const;
    [[nodiscard]] std::optional<Share> told(std::int64_t number, const Job& job) const;
    [[nodiscard]] std::optional<Share> failed(std::int64_t number, const Job& job) const;
    Job leave_with(std::int64_t number);
    [[nodiscard]] Clock::duration lease() const;
    [[nodiscard]] Clock::duration measured_lease() const;

    void miss(const Identity& identity, Clock::time_point now);
    void count_missed(const Identity& identity);
    void wait(const EmissionPtr& event);
    EmissionPtr take_fresh();
    [[nodiscard]] bool overfull(Clock::time_point now) const;
    bool drop_oldest(Clock::time_point now);
    void pump(Clock::time_point now, Decisions& decisions);
    Consumers::iterator choose(std::int64_t job, const EmissionPtr& event);
    void give(Consumers::iterator to, std::int64_t number, Clock::time_point now, Decisions& decisions);
    void tell_end(Decisions& decisions);
    void revoke_end(Decisions& decisions);
    void acknowledge(Consumer& consumer, std::int64_t count);
    void close(std::int64_t job, Fate fate);
    void pass_on(Consumer& consumer, Handed& handed, bool failed, bool holds);
    void let_go(ReceiverId id, Consumer& consumer, Fate how, bool returns, Clock::time_point now);
    [[nodiscard]] bool may_show(const Consumer& consumer, const EmissionPtr& event) const;
    void show_hands(ReceiverId id, const Consumer& consumer, Decisions& decisions) const;
    void resume(Consumer& consumer, Away away, const Kept& kept, Clock::time_point now, Decisions& decisions);
    void take_back(Away& away, std::int64_t count);
    void reclaim(Away& away, std::int64_t count, Decisions& decisions);
    void abandon_exhausted(Decisions& decisions);
    void last_one_left(Consumer&& last, Fate how, bool returns, Clock::time_point now, Decisions& decisions);
    void skip_newest_live();
    void end_live(Fate how);
    [[nodiscard]] EmissionPtr next() const;
    [[nodiscard]] bool lanes_full(const Emission& event) const;
    void settle(Decisions& decisions);
    void abandon(std::int64_t number, Decisions& decisions);
    void count(Fate fate, std::int64_t events = 1);
    void give_up(bool also_in_doubt, Decisions& decisions);
    void clear(Fate how);

    Kind kind_;
    Ledger ledger_;
    Consumers consumers_;
    std::map<std::int64_t, Job> open_;  ///< by number
    std::set<std::int64_t> again_;      ///< those to be dispatched again
    std::deque<EmissionPtr> fresh_;
    std::size_t fresh_bytes_ = 0;
    Clock::time_point behind_since_{};  ///< since when an event has been waiting
    std::int64_t jobs_;                 ///< the number of the last one
    std::uint64_t order_ = 0;
    std::array<Clock::duration, 64> recent_times_{};  ///< of shared work
    std::size_t times_ = 0;                           ///< measured so far
    std::int64_t last_lost_us_ = 0;
    std::optional<bool> lossless_;  ///< was the last event lossless? The next one probably is too
    bool awaited_ = false, ended_ = false;
    std::optional<Clock::time_point> awaited_until_;
    std::optional<Away> away_;  ///< set while not shared and awaited
    std::optional<Fate> missing_as_;
    Clock::time_point live_missed_until_{};
    Missed missed_;
    bool missed_more_ = false;                      ///< since the last tick
    std::int64_t unsure_from_ = 0, unsure_to_ = 0;  ///< deliveries counted as missed, unless the consumer got them
};

/// What a shared subscription remembers of a consumer between its registrations.
struct Subscription::Member {
    Ledger ledger;
    ReceiverId newest = 0;       ///< its last registration
    bool local = false;          ///< it is on this machine, where lost_killed is certain
    std::optional<Away> away{};  ///< what that had in hand when its connection ended; kept for 30 s
};

}  // namespace hive::event
