// Who receives an output, and what each gets when: credit, windows, notifications, groups with leases. Pure logic:
// no sockets, no clock; it is told what happened and decides what is to be sent (SPEC.md, sections 5 and 8).
#pragma once

#include <hive/event/clock.hpp>
#include <hive/event/emission.hpp>
#include <hive/transfer.hpp>

#include <array>
#include <deque>
#include <map>
#include <string>
#include <vector>

namespace hive::event {

/// What became of the events of one receiver or group: produced = delivered + skipped + dropped + abandoned +
/// in_flight.
struct Counts {
    std::int64_t produced = 0;   ///< while it was registered
    std::int64_t delivered = 0;  ///< handed to the operating system; in a group: acknowledged
    std::int64_t skipped = 0;    ///< a newer one took its place before the receiver asked
    std::int64_t dropped = 0;    ///< the queue of a streaming receiver was full
    std::int64_t abandoned = 0;  ///< shared work that failed in every attempt
    std::int64_t in_flight = 0;
};

class ReceiverTable {
public:
    using Id = std::uint64_t;

    static constexpr int most_attempts = 3;
    static constexpr std::size_t most_queued_events = 1024;     ///< of a streaming receiver, when they are small
    static constexpr std::size_t most_queued_bytes = 1u << 20;  ///< beyond two events
    static constexpr std::size_t most_empty_groups = 16;        ///< remembered, with their turns and what waits in them
    static constexpr std::size_t lane_bytes = 64 * 1024;        ///< handed to the transport at once, beyond one event

    /// A decision: give this event to this receiver.
    struct Send {
        Id receiver;
        EmissionPtr event;
        Delivery delivery;
        Share share;  ///< empty outside groups
    };
    /// What a call decided: what to send now, and which shared events are given up.
    struct Decisions {
        std::vector<Send> sends;
        std::vector<EmissionPtr> failed;  ///< with the group, turn and attempt of the last attempt, if there was one
    };
    struct Row {
        Id id;
        std::string receiver;
        std::int64_t epoch;
        ConnectionOptions options;
        Counts counts;
    };

    /// Switches for tests that prove a defence by its absence.
    struct Defences {
        bool leases = true;
    };
    explicit ReceiverTable(Defences defences = {true}) : defences_(defences) {}

    /// A receiver registered; `epoch` is its registration's.
    Decisions add(Id id, std::string receiver, std::int64_t epoch, const ConnectionOptions& options,
                  Clock::time_point now);
    /// It deregistered, or its connection ended (`left` false: it may come back, so work that it had as the last of its
    /// group waits).
    Decisions remove(Id id, bool left, Clock::time_point now);
    /// It asked: both numbers count from its registration.
    Decisions request(Id id, std::int64_t epoch, std::int64_t asked, std::int64_t done, Clock::time_point now);
    /// The transport has written an event that was sent.
    Decisions written(Id id, std::size_t size, Clock::time_point now);
    /// The drone emitted. @param hold  keep a lossless event for the first receiver of bodies to come, if there is none
    Decisions offer(EmissionPtr event, bool hold, Clock::time_point now);
    /// Time passed: leases may have expired.
    Decisions tick(Clock::time_point now);

    /// Does anybody receive bodies?
    [[nodiscard]] bool wanted() const noexcept;
    /// Has every receiver of bodies asked for an event that it has not got (and is there one)?
    [[nodiscard]] bool asked() const;
    /// Do lossless events wait for somebody to ask?
    [[nodiscard]] bool backlogged() const;
    /// Is there work on lease, so that tick() is needed?
    [[nodiscard]] bool leasing() const;
    /// Receivers first, then one row for each group with members or work under the name "group NAME".
    [[nodiscard]] std::vector<Row> rows() const;

private:
    struct Job {
        EmissionPtr event;
        std::int64_t turn = 0;  ///< given when it first goes out
        int attempt = 0;        ///< attempts made so far
    };
    struct Lease {
        Job job;  ///< without event: it was taken back, the number alone is awaited
    };
    struct Receiver {
        std::string name;
        std::int64_t epoch = 0;
        ConnectionOptions options;
        std::int64_t asked = 0, sent = 0, done = 0;
        std::deque<EmissionPtr> waiting;
        std::size_t waiting_bytes = 0;
        std::size_t lane_events = 0, lane_bytes = 0;
        std::deque<Lease> leases;        ///< group members: in the order of delivery, numbers done+1 …
        Clock::time_point head_since{};  ///< when the first lease became the one being worked on
        std::uint64_t idle_since = 0;    ///< order in which members asked
        bool suspect = false;            ///< a lease of it expired: gets nothing until it answers
        Counts counts;

        [[nodiscard]] bool streaming() const { return options.transfer == Transfer::streaming; }
        [[nodiscard]] bool has_credit() const { return streaming() || asked > sent; }
        [[nodiscard]] bool lane_free(std::size_t next) const;
        [[nodiscard]] bool counts_for_demand() const
        {
            return options.delivery == Delivery::data && options.group.empty();
        }
    };
    /// How long the work of a group takes, for its leases.
    class WorkTimes {
    public:
        void add(Clock::duration time);
        [[nodiscard]] Clock::duration lease() const;

    private:
        std::array<Clock::duration, 64> recent_{};
        std::size_t count_ = 0;
    };
    struct Group {
        std::deque<Job> waiting;  ///< taken back first, then new ones
        int members = 0;
        bool awaited = false;  ///< its last member was lost with work on demand, so the source waits for the next one
        std::uint64_t emptied = 0;  ///< order in which groups lost their last members
        std::int64_t turns = 0;
        WorkTimes times;
        Counts counts;

        [[nodiscard]] bool active() const { return members > 0 || awaited; }
    };

    void pump(Id id, Receiver& receiver, Decisions& decisions);
    void pump_group(const std::string& name, Clock::time_point now, Decisions& decisions);
    void offer_receiver(Id id, Receiver& receiver, const EmissionPtr& event, Decisions& decisions);
    void offer_group(const std::string& name, Group& group, const EmissionPtr& event, Clock::time_point now,
                     Decisions& decisions);
    void acknowledge(Receiver& member, std::int64_t done, Clock::time_point now);
    void take_back(Receiver& member, Group& group, Decisions& decisions);
    void empty(const std::string& name, Group& group, bool left, Decisions& decisions);
    void forget_oldest(Decisions& decisions);
    void give_up(const Job& job, const std::string& name, Group& group, Decisions& decisions);
    void give_up_waiting(const std::string& name, Group& group, Decisions& decisions);
    void drop_oldest(Receiver& receiver);
    Receiver* next_member(const std::string& group, std::size_t size, Id& id);
    [[nodiscard]] Clock::duration lease_of(const Receiver& member) const;
    [[nodiscard]] std::int64_t group_credit(const std::string& name) const;

    Defences defences_;
    std::map<Id, Receiver> receivers_;
    std::map<std::string, Group> groups_;
    std::deque<EmissionPtr> held_;  ///< lossless events that had no receiver yet
    EmissionPtr newest_;
    std::uint64_t asking_order_ = 0, emptying_order_ = 0;
};

}  // namespace hive::event
