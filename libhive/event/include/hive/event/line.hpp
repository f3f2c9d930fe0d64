// A plain receiver of an output: what waits for it, what it has in hand, and the place that is kept for it when it is
// cut off (SPEC.md, section 5).
#pragma once

#include <hive/event/clock.hpp>
#include <hive/event/credit.hpp>
#include <hive/event/emission.hpp>
#include <hive/status.hpp>

#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace hive::event {

using ReceiverId = std::uint64_t;

/// A decision: give this event to this receiver.
struct Send {
    ReceiverId receiver;
    EmissionPtr event;
    Delivery delivery;
    std::optional<Share> share;  ///< what it is told of whose work this is, where that is not the same for all
};
/// What a call decided: what to send now, and which events are given up.
struct Decisions {
    std::vector<Send> sends;
    std::vector<EmissionPtr> failed;  ///< with the share of the last attempt, if there was one
    std::vector<ReceiverId> ends;     ///< who is to hear, behind what is sent, that nothing more will come
};

/// Pure logic: it is told what happened and decides. The ledger belongs to the table and outlives it.
class Line {
public:
    static constexpr std::size_t most_queued_events = 1024;     ///< of a streaming receiver, when they are small
    static constexpr std::size_t most_queued_bytes = 1u << 20;  ///< beyond two events
    /// Who has not caught up for so long is too slow: what waits is only age, so two events and 64 KiB are enough then.
    static constexpr auto most_behind = std::chrono::milliseconds(500);
    static constexpr int most_failures = 3;  ///< deaths of the receiver over one lossless event
    static constexpr auto place_kept = std::chrono::seconds(30);

    /// @param guest  it gets what there is, and nobody waits for it: what is lossless to others is live to it
    Line(ReceiverId id, std::string receiver, std::int64_t epoch, const ConnectionOptions& options, Ledger& ledger,
         bool guest = false);

    void offer(const EmissionPtr& event, Clock::time_point now, Decisions& decisions);
    void request(std::int64_t epoch, const Progress& progress, Decisions& decisions);
    void written(std::size_t bytes, Decisions& decisions);

    /// Its connection ended. @param keep  whether what is lossless waits for it to come back
    /// @return  whether its place is kept
    bool lose(Fate how, bool keep, Clock::time_point now);
    /// It is back, under a new id. @param taken  how many deliveries it has had; nothing: it began anew and has had
    /// none that it did not acknowledge. The deliveries go on behind the number returned.
    std::int64_t resume(ReceiverId id, std::int64_t epoch, const ConnectionOptions& options,
                        std::optional<std::int64_t> taken, Decisions& decisions);
    /// Sends what may be sent, after resume().
    void pump(Decisions& decisions);
    /// Nothing more will come: tells it behind all that waits.
    void end(Decisions& decisions);
    /// Something may come again.
    void go_on() { ending_ = false; }
    /// Its place is not kept any longer.
    void expire();
    /// Whatever is in flight goes.
    void clear(Fate how);

    [[nodiscard]] const std::string& receiver() const noexcept { return receiver_; }
    [[nodiscard]] const ConnectionOptions& options() const noexcept { return options_; }
    [[nodiscard]] std::int64_t epoch() const noexcept { return epoch_; }
    [[nodiscard]] bool kept() const noexcept { return kept_until_.has_value(); }
    [[nodiscard]] bool overdue(Clock::time_point now) const { return kept_until_ && *kept_until_ <= now; }
    /// Are there lossless events that it has not acknowledged, or may there be one next?
    [[nodiscard]] bool worth_keeping() const;
    [[nodiscard]] bool takes_bodies() const noexcept { return options_.delivery == Delivery::data; }
    /// Does a source of lossless events wait for it?
    [[nodiscard]] bool awaited() const noexcept { return takes_bodies() && !guest_; }
    /// Has it asked for an event that it has not got?
    [[nodiscard]] bool asks() const;
    /// Do lossless events wait for it?
    [[nodiscard]] bool backlogged() const;
    [[nodiscard]] std::int64_t waiting() const { return static_cast<std::int64_t>(waiting_.size()); }
    [[nodiscard]] Reason why() const;

private:
    struct Item {
        EmissionPtr event;  ///< null in hand: it was live, and nobody would send it again
        int attempt = 0;    ///< deliveries so far
        int failures = 0;
    };
    static bool live(const Item& item) { return !item.event || !item.event->lossless(); }
    [[nodiscard]] bool must_stay(const EmissionPtr& event) const { return event->lossless() && awaited(); }
    [[nodiscard]] bool overfull(Clock::time_point now) const;
    bool drop_oldest(Clock::time_point now);
    void wait(Item item, bool first);
    Item next();
    void put_back(std::int64_t taken);
    [[nodiscard]] std::optional<Share> told(const Item& item) const;
    void abandon(const Item& item, Decisions& decisions);

    ReceiverId id_;
    std::string receiver_;
    std::int64_t epoch_;
    ConnectionOptions options_;
    Ledger* ledger_;
    Credit credit_;
    std::deque<Item> waiting_, in_hand_;
    std::size_t waiting_bytes_ = 0;
    Clock::time_point behind_since_{};  ///< something has waited ever since
    std::optional<bool> lossless_;      ///< was the last event offered? Then its source waits for its receivers
    bool guest_ = false;
    bool ending_ = false;  ///< the receiver is still to be told of the end
    std::optional<Clock::time_point> kept_until_;
    Fate lost_as_ = Fate::lost_connection;  ///< when its place was kept last
};

}  // namespace hive::event
