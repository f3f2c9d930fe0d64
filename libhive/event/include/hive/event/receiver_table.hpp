// The subscriptions of an output, by name: who registers, takes whose place, leaves, is lost and is remembered
// (SPEC.md, sections 5 and 8).
#pragma once

#include <hive/event/subscription.hpp>

#include <list>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace hive::event {

/// A registration, as far as the table is concerned.
struct Newcomer {
    ReceiverId id = 0;
    std::string receiver;
    std::int64_t epoch = 0;  ///< of the registration
    ConnectionOptions options = {};
    std::int64_t place = 0;                  ///< the place that it had, 0: none that it knows of
    std::optional<std::int64_t> taken = {};  ///< at that place
    std::int64_t held = 0;                   ///< of what it has taken at any place, not processed yet
    std::int64_t tried = 0;  ///< epoch of the first registration since it was last confirmed, this one included
    std::int64_t run = 0;    ///< the epoch of its module: another run of a drone has another
    bool unique = false;     ///< a drone's: what is kept under its name is its own
    bool guest = false;      ///< it looks on, and nobody waits for it
    /// If it stands elsewhere: that registration deals with what it has in hand before it ends.
    bool drains = false;
};

/// What the newcomer is told, and whose place it takes.
struct Welcome {
    std::int64_t place = 0;            ///< where it may come back to; 0 in a group
    std::int64_t taken = 0;            ///< its deliveries go on behind this number
    std::optional<Share> group{};      ///< how far the turns of its group are
    std::optional<ReceiverId> ends{};  ///< the registration that ends by this one
};

/// A receiver that a source waits for, or has stopped waiting for and still counts what it misses. What a drone
/// remembers of it is enough for its next run to do the same.
struct Subscriber {
    std::string output;
    std::string receiver;
    std::string group{};   ///< that it shares the events with; empty: none
    std::int64_t pid = 0;  ///< of an application on this machine, which comes again only as long as it lives
    Subscription::Missed missed{};
    bool dormant = false;  ///< the source does not wait for it any longer

    bool operator==(const Subscriber&) const = default;
};

/// Pure logic: no sockets, no clock; it is told what happened and decides what is to be sent.
class ReceiverTable {
public:
    using Id = ReceiverId;

    static constexpr std::size_t max_empty_groups = 16;  ///< remembered, with their turns and what waits in them
    static constexpr std::size_t max_gone = 64;          ///< receivers that left or were lost: their counts are kept
    static constexpr std::size_t max_awaited = 256;      ///< of them, that the source waits for

    struct Row {
        Id id;  ///< 0: a group, or a receiver that is not registered now
        EdgeStatus status;
    };
    /// Switches for tests that prove a defence by its absence.
    struct Defences {
        bool leases = true, places = true;
    };
    /// @param output  of this drone: "camera.image"
    /// @param epoch   of this module
    explicit ReceiverTable(std::string output, std::int64_t epoch = 0, Defences defences = {true, true})
        : output_(std::move(output)), epoch_(epoch), defences_(defences)
    {
    }
    ReceiverTable(const ReceiverTable&) = delete;
    ReceiverTable& operator=(const ReceiverTable&) = delete;

    Welcome add(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    /// It deregistered.
    void leave(Id id, Clock::time_point now, Decisions& decisions);
    /// Its connection ended. @param returns  it may come back
    void lose(Id id, Fate how, bool returns, Clock::time_point now, Decisions& decisions);
    void request(Id id, std::int64_t epoch, const Progress& progress, const std::vector<std::int64_t>& back,
                 Clock::time_point now, Decisions& decisions);
    /// The transport has written an event that was sent.
    void written(Id id, std::size_t bytes, Clock::time_point now, Decisions& decisions);
    /// The drone emitted. @param hold  keep a lossless event for the first receiver of bodies to come, if there is none
    void offer(const EmissionPtr& event, bool hold, Clock::time_point now, Decisions& decisions);
    /// Nothing more will come: everybody is told, behind what waits for them, and so is who registers later.
    void end(Clock::time_point now, Decisions& decisions);
    /// Something may come again; so may it when an event is offered.
    void go_on(Decisions& decisions);
    [[nodiscard]] bool told_end(Id id) const;
    [[nodiscard]] bool ended() const noexcept { return ended_; }
    /// Nobody needs to wait for a first receiver here: another output has one.
    void release_held();
    /// Time passed: leases or places may have expired.
    void tick(Clock::time_point now, Decisions& decisions);
    /// An earlier run of this drone had this one.
    /// @param until  wait so long for it; empty: until it is there
    void expect(const Subscriber& subscriber, std::optional<Clock::time_point> until);
    /// The registrations of this drone, or of one input of it.
    [[nodiscard]] std::vector<Id> registered(const std::string& drone) const;
    /// Nobody waits for this drone any longer. @return  how many places and groups waited for it
    std::size_t forget(const std::string& drone, Decisions& decisions);
    /// Number of lossless events that this receiver missed while it was away; see Subscription::missed().
    [[nodiscard]] std::int64_t missed(Id id) const;

    /// Which registration does this newcomer follow, if any?
    [[nodiscard]] std::optional<Id> standing(const Newcomer& newcomer) const;
    /// Does anybody receive bodies, or is to have them when it is back?
    [[nodiscard]] bool wanted() const noexcept;
    /// Does each event go to several plain receivers of bodies, those that are awaited included?
    [[nodiscard]] bool fans_out() const;
    /// As wanted(), but for guests.
    [[nodiscard]] bool awaited() const noexcept;
    /// Has every receiver of bodies that is no guest asked for an event that it has not got (and is there one)?
    [[nodiscard]] bool asked() const;
    /// Do lossless events wait for somebody to ask?
    [[nodiscard]] bool backlogged() const;
    /// Do events wait for a first receiver?
    [[nodiscard]] bool holds() const noexcept { return !held_.empty(); }
    /// Is there anything that tick() decides about?
    [[nodiscard]] bool timed() const;
    [[nodiscard]] Reason why() const;
    [[nodiscard]] std::int64_t unreceived() const noexcept { return unreceived_; }
    /// The last event that was offered here, null: none was.
    [[nodiscard]] const Event* newest() const { return newest_ ? &newest_->event() : nullptr; }
    /// Without outputs and processes.
    [[nodiscard]] std::vector<Subscriber> subscribers() const;
    /// Receivers first, then groups under the name "group NAME", then those that were lost.
    [[nodiscard]] std::vector<Row> rows() const;

private:
    /// A receiver's registrations, present and past.
    struct Registered {
        ConnectionOptions options{};
        std::int64_t newest = 0;  ///< epoch
        int now = 0;
        std::uint64_t gone = 0;  ///< order in which receivers lost their last
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
        Ledger ledger;
        Registered registered{};
    };
    struct Group {
        Subscription subscription;
        std::map<std::string, Member> members{};  ///< also those that were lost
        std::set<std::string> lost{};             ///< members that may come back
        std::uint64_t emptied = 0;                ///< order in which groups lost their last member; 0: it has some
    };
    struct Seat {  ///< a registration
        std::string receiver;
        std::int64_t run = 0;
        std::int64_t registration = 0;
        Plain* plain = nullptr;
        bool is_back = false;      ///< `plain` went on, and did not begin with it
        Group* group = nullptr;    ///< one of the two
        std::optional<Id> heir{};  ///< it was followed by this one, and deals with what it has in hand

        [[nodiscard]] Subscription& subscription() const { return plain ? plain->subscription : group->subscription; }
    };

    [[nodiscard]] static bool is_at(const Plain& plain, const Newcomer& newcomer);
    [[nodiscard]] std::int64_t row_of(const Plain& plain) const;
    Plain& plain_for(const Newcomer& newcomer);
    Group& group_named(const std::string& name);
    Welcome seat(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    Welcome join(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    std::optional<Id> make_way(Id before, const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    [[nodiscard]] bool was_last(Group& group, const Newcomer& newcomer);
    void inherit(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    void offer_held(const Newcomer& newcomer, Clock::time_point now, Decisions& decisions);
    void depart(Id id, Fate how, bool returns, Clock::time_point now, Decisions& decisions);
    void bequeath(Id before, Id heir);
    void departed(const Seat& seat, Fate how, bool followed);
    void unregister(Registered& registered);
    [[nodiscard]] bool any(bool (Subscription::*like)() const) const;
    [[nodiscard]] bool waits() const;
    void forget_awaited();
    void forget_gone();
    void forget_empty_groups(Decisions& decisions);

    std::string output_;
    std::int64_t epoch_;
    Defences defences_;
    std::list<Plain> plain_;
    std::map<std::string, Group> groups_;
    std::map<Id, Seat> seats_;
    std::deque<EmissionPtr> held_;  ///< lossless events that had no receiver yet
    EmissionPtr newest_;
    bool ended_ = false;
    std::int64_t unreceived_ = 0;
    std::uint64_t order_ = 0;
};

}  // namespace hive::event
