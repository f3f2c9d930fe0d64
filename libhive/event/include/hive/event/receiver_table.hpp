// The subscriptions of an output, by name: registration, replacement, departure, loss and memory of receivers (SPEC.md,
// sections 5 and 8).
#pragma once

#include <hive/event/subscription.hpp>

#include <list>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hive::event {

/// The part of a registration that the table needs.
struct Newcomer {
    ReceiverId id = 0;
    std::string receiver;
    std::int64_t epoch = 0;  ///< of the registration
    ConnectionOptions options = {};
    std::int64_t place = 0;                  ///< its previous place; 0: none
    std::optional<std::int64_t> taken = {};  ///< deliveries received at that place
    std::int64_t held = 0;                   ///< deliveries received at any place and not processed yet
    std::int64_t tried = 0;  ///< epoch of the first registration since the last confirmed one, including this one
    std::int64_t run = 0;    ///< the epoch of its module, different for each run of a drone
    bool unique = false;     ///< a drone's: the records under its name are its own
    bool guest = false;      ///< passive: no source waits for it
    bool local = false;      ///< on this machine
    /// If it is registered elsewhere: that registration finishes its events in progress before it ends.
    bool drains = false;
};

/// The answer to a new registration, and the registration that it replaces.
struct Welcome {
    std::int64_t place = 0;            ///< the place at which it may resume
    std::int64_t taken = 0;            ///< its deliveries continue after this number
    std::optional<Share> group{};      ///< the progress of its group's turns
    std::optional<ReceiverId> ends{};  ///< the registration that is replaced by this one
};

/// A receiver for which a source waits, or for which it has stopped waiting but still counts missed events. A drone
/// saves these fields so that its next run can do the same.
struct Subscriber {
    std::string output;
    std::string receiver;
    std::string group{};   ///< with which it shares the events; empty: none
    std::int64_t pid = 0;  ///< of an application on this machine, which can return only while this process runs
    Subscription::Missed missed{};
    bool dormant = false;  ///< the source no longer waits for it

    bool operator==(const Subscriber&) const = default;
};

/// What the receivers of an output want of its drone.
struct Demand {
    bool wanted = false;      ///< is there a receiver of bodies, present or awaited?
    bool fans_out = false;    ///< does each event go to several plain ones of these?
    bool asked = false;       ///< is one not a guest, and has each of these requested an event that it has not got?
    bool backlogged = false;  ///< do lossless events wait for a request?
};

/// Pure logic: no sockets, no clock for decisions; the caller reports events, and the table decides what to send.
class ReceiverTable {
public:
    using Id = ReceiverId;

    static constexpr std::size_t max_forgotten_groups = 1024;  ///< whose last turn is remembered
    static constexpr std::size_t max_empty_groups = 16;        ///< remembered, with their turns and waiting events
    static constexpr std::size_t max_gone = 64;      ///< receivers that left or were lost, whose counts are kept
    static constexpr std::size_t max_awaited = 256;  ///< receivers, and groups, for which the source waits

    struct Row {
        Id id;  ///< 0: a group, or a receiver without a current registration
        EdgeStatus status;
    };
    /// Switches of tests that show a defence by its absence.
    struct Defences {
        bool leases = true, places = true;
    };
    /// @param output  the output of this drone: "camera.image"
    /// @param epoch  of this module
    explicit ReceiverTable(std::string output, std::int64_t epoch = 0, Defences defences = {true, true})
        : output_(std::move(output)), epoch_(epoch), defences_(defences)
    {
    }
    ReceiverTable(const ReceiverTable&) = delete;
    ReceiverTable& operator=(const ReceiverTable&) = delete;

    Welcome add(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    /// The receiver deregistered.
    void leave(Id id, Clock::time_point now, Decisions& decisions);
    /// Its connection ended. @param returns  it may return
    void lose(Id id, Fate how, bool returns, Clock::time_point now, Decisions& decisions);
    void request(Id id, std::int64_t epoch, const Progress& progress, const std::vector<std::int64_t>& back,
                 Clock::time_point now, Decisions& decisions);
    /// The transport has written an event that was sent.
    void written(Id id, std::size_t bytes, Clock::time_point now, Decisions& decisions);
    /// The drone emitted. @param hold  keep a lossless event for the first receiver of bodies, if there is none
    void offer(const EmissionPtr& event, bool hold, Clock::time_point now, Decisions& decisions);
    /// Nothing more will come: every receiver gets the end after its waiting events, even those that register later.
    void end(Clock::time_point now, Decisions& decisions);
    /// Something may come again; offer() implies this.
    void go_on(Decisions& decisions);
    [[nodiscard]] bool told_end(Id id) const;
    [[nodiscard]] bool ended() const noexcept { return ended_; }
    /// Drops held events: another output has a receiver.
    void release_held();
    /// Handles expired leases and places.
    void tick(Clock::time_point now, Decisions& decisions);
    /// An earlier run of this drone had this subscriber.
    /// @param until  how long to wait for it; empty: until it is there
    void expect(const Subscriber& subscriber, std::optional<Clock::time_point> until);
    /// The registrations of this drone, or of one input of it.
    [[nodiscard]] std::vector<Id> registered(const std::string& drone) const;
    /// Stops waiting for this drone. @return number of places and groups that waited for it
    std::size_t forget(const std::string& drone, Decisions& decisions);
    /// Number of lossless events that this receiver missed while it was away; see Subscription::missed().
    [[nodiscard]] std::int64_t missed(Id id) const;

    /// The registration that this new one replaces, if any.
    [[nodiscard]] std::optional<Id> standing(const Newcomer& newcomer) const;
    [[nodiscard]] Demand demand() const;
    /// Is there a receiver of bodies other than guests, present or awaited?
    [[nodiscard]] bool awaited() const noexcept;
    /// Do events wait for a first receiver?
    [[nodiscard]] bool holds() const noexcept { return !held_.empty(); }
    /// Does tick() have to be called?
    [[nodiscard]] bool timed() const;
    [[nodiscard]] Reason why() const;
    [[nodiscard]] std::int64_t unreceived() const noexcept { return unreceived_; }
    /// The last offered event; null: none.
    [[nodiscard]] const Event* newest() const { return newest_ ? &newest_->event() : nullptr; }
    /// Without outputs and processes.
    [[nodiscard]] std::vector<Subscriber> subscribers() const;
    /// Receivers first, then groups under the name "group NAME", then those that were lost.
    [[nodiscard]] std::vector<Row> rows() const;

private:
    /// The current and past registrations of a receiver.
    struct Registered {
        ConnectionOptions options{};
        std::int64_t newest = 0;  ///< epoch
        int now = 0;
        std::uint64_t gone = 0;  ///< order in which receivers lost their last one
    };
    struct Plain {
        std::string receiver;
        Subscription subscription;
        std::int64_t place = 0;
        std::int64_t tried = 0;  ///< by its last consumer
        std::int64_t run = 0;    ///< of the module of its last consumer
        Registered registered{};
        bool unique = true;  ///< a drone's; false: the next receiver of this name may be another application
    };
    struct Member {
        Subscription::Member kept{};
        std::int64_t place = 0;
        Registered registered{};
    };
    struct Group {
        Subscription subscription;
        std::map<std::string, Member> members{};  ///< including lost ones
        /// Members that may return, and until when; nullopt: no limit.
        std::map<std::string, std::optional<Clock::time_point>> lost{};
        std::uint64_t emptied = 0;  ///< order in which groups lost their last member; 0: not empty
    };
    struct Seat {  ///< a registration
        std::string receiver;
        std::int64_t run = 0;
        std::int64_t registration = 0;
        Plain* plain = nullptr;
        bool is_back = false;      ///< it resumed `plain`, which existed before
        Group* group = nullptr;    ///< one of the two
        std::int64_t place = 0;    ///< in the group
        std::optional<Id> heir{};  ///< the registration that replaced it while it finishes its events in progress

        [[nodiscard]] Subscription& subscription() const { return plain ? plain->subscription : group->subscription; }
    };

    [[nodiscard]] static bool is_at(const Plain& plain, const Newcomer& newcomer);
    [[nodiscard]] bool is_at(const Seat& seat, const Newcomer& newcomer) const;
    [[nodiscard]] std::int64_t row_of(const Plain& plain) const;
    Plain& plain_for(const Newcomer& newcomer);
    Group& group_named(const std::string& name);
    Welcome seat(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    Welcome join(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    std::optional<Id> make_way(Id before, const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    [[nodiscard]] bool was_last(Group& group, const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    void inherit(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    void offer_held(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    void depart(Id id, Fate how, bool returns, Clock::time_point now, Decisions& decisions);
    void bequeath(Id before, Id heir);
    void departed(const Seat& seat, Fate how, bool followed, bool returns, Clock::time_point now, Decisions& decisions);
    static void remember_lost(Group& group, const std::string& receiver, Clock::time_point now);
    static void forget_expired(Group& group, Clock::time_point now);
    void unregister(Registered& registered);
    [[nodiscard]] bool any(bool (Subscription::*like)() const) const;
    [[nodiscard]] bool waits() const;
    void forget_awaited();
    void stop_waiting(Group& group, Decisions& decisions);
    void forget_gone();
    void forget_empty_groups(Decisions& decisions);

    std::string output_;
    std::int64_t epoch_;
    Defences defences_;
    std::list<Plain> plain_;
    std::map<std::string, Group> groups_;
    std::map<Id, Seat> seats_;
    std::deque<EmissionPtr> held_;  ///< lossless events without a receiver so far
    EmissionPtr newest_;
    bool ended_ = false;
    std::int64_t unreceived_ = 0;
    std::uint64_t order_ = 0;
    std::map<std::string, std::int64_t>
        forgotten_turns_;          ///< the last of each forgotten group, which goes on from there
    std::int64_t least_turn_ = 0;  ///< from which all others go on
};

}  // namespace hive::event
