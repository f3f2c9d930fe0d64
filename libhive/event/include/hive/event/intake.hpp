// An input's connection to one output of another module: registers, requests, acknowledges, and reconnects after a
// loss.
#pragma once

#include <hive/backoff.hpp>
#include <hive/event/input_progress.hpp>
#include <hive/event/link.hpp>
#include <hive/event/ticket.hpp>
#include <hive/platform/timer.hpp>
#include <hive/status.hpp>
#include <hive/transport/transport.hpp>

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace hive::event {

class Module;

struct IntakeSpec {
    std::string sender = {};  ///< the drone
    std::string output = {};
    transport::Address address = {};  ///< the sender's address
    std::string input = {};           ///< of this module
    std::string receiver = {};        ///< this end's name at the sender: "face.image"
    std::string accepts = "*/*";
    bool stateful = false;
    ConnectionOptions options = {};

    bool operator==(const IntakeSpec&) const = default;
};

/// The progress of a group's turns, as known to one of its members.
struct Standing {
    Share share;                     ///< its turn: the last one dispatched to any member, as far as this member knows
    std::vector<std::int64_t> open;  ///< the member's turns in progress
};

/// Network side; objects with a ticket may be dropped on any thread.
class Intake : public std::enable_shared_from_this<Intake> {
public:
    using Sink = std::function<void(Event&&)>;

    /// @param on_end  called when something has changed that EndOfInputs checks
    Intake(
        Module& module, IntakeSpec spec, Sink sink, std::function<void()> on_end = [] {});

    /// Counts an event that did not arrive over this connection, and passes it on.
    void accept(Event event);
    /// Dials and registers. `first` gets the outcome of the first attempt that is answered, of the third that does not
    /// reach the sender, or of the last one for which there is time. Later losses are repaired silently.
    void start(OnOutcome first, Clock::time_point until = {});
    /// Starts again with other options at the same place, so that nothing is lost or repeated. Until the sender
    /// confirms them, and if it does not, the old options stay. For a connected intake that neither is nor becomes a
    /// member of a group.
    void change(const ConnectionOptions& options, OnOutcome first, Clock::time_point until);
    /// True while a caller waits for the outcome of three attempts. Then another one may wait for it as well.
    [[nodiscard]] bool awaited() const noexcept { return first_ && first_until_ != Clock::time_point(); }
    void await(OnOutcome another, Clock::time_point until);
    /// Answers the callers that wait, if any.
    void answer(const Outcome& outcome);
    /// No event arrives after this. Finishes shared or lossless work in progress, then deregisters. `left` is called
    /// when the sender has confirmed, or cannot.
    void stop(std::function<void()> left = [] {});
    /// After stop(): no longer waits for work in progress; its sender may dispatch it to others.
    void leave_now();
    /// The options that the sender has confirmed.
    [[nodiscard]] const ConnectionOptions& confirmed_options() const { return before_ ? *before_ : spec_.options; }
    void acknowledge_held();
    /// Another process continues at this place: the sender gets the acknowledgements but no end, and sends the rest to
    /// that process. After this nothing is acknowledged.
    void hand_over();
    /// Is there work in progress, or a result that is not acknowledged yet?
    [[nodiscard]] bool owes() const { return progress_.owes(); }
    /// Requests as many events as possible now. @param late  and reports what could wait for a moment
    void flush(bool late = false);
    /// Another intake is being made that will replace this one: until go_on(), this one does not reconnect to the
    /// sender, which would treat it as the newer of the two.
    void hold() { ++held_; }
    void let_go_on();
    void link_closed(const Link& link);
    /// An event was processed, or is finished; `ending` is the outcome.
    void heard(std::int64_t generation, std::int64_t number, bool worked, bool done, std::optional<Ending> ending);

    [[nodiscard]] const IntakeSpec& spec() const noexcept { return spec_; }
    [[nodiscard]] bool connected() const noexcept { return connected_; }
    [[nodiscard]] bool stopped() const noexcept { return stage_ != Stage::taking; }
    /// Why the sender, or another module at its address, refuses this connection, if that is why it is not connected.
    [[nodiscard]] std::optional<Error> refusal() const;
    /// The text of the sender's end, if it has ended.
    [[nodiscard]] const std::optional<std::string>& ended() const noexcept { return end_; }
    /// Asks the sender whether the end still holds. @param within  how long to wait for the answer
    void ask_end(std::chrono::milliseconds within);
    /// Was it asked, and may still answer? One that is lost may come back with another source.
    [[nodiscard]] bool unsure() const;
    /// Has everything that came been worked on?
    [[nodiscard]] bool all_worked() const noexcept { return !progress_.works(); }
    /// Does the sender know, or is it not there, that this one is gone?
    [[nodiscard]] bool has_left() const noexcept { return stage_ == Stage::left; }
    /// Notes whether other senders do the work of this one, which is lost. @param all  inputs with the same end
    void look_at_others(const std::vector<std::shared_ptr<Intake>>& all);
    /// May the end of the other inputs ignore this sender, because it is lost or stopped (SPEC.md, section 5.6)?
    [[nodiscard]] bool gone_for_good() const;
    /// What is missing if the end did not wait for this sender; empty: nothing.
    [[nodiscard]] std::string lacks() const;
    /// Without `queued`, which the owner of the queue fills in: until then queued events count as in progress.
    [[nodiscard]] InputStatus status() const;
    /// The progress of its group.
    [[nodiscard]] std::optional<Standing> standing() const;

private:
    enum class Stage {
        taking,
        draining,  ///< work in progress is being finished
        leaving,   ///< the sender was told, or is unreachable
        left,
    };
    void attempt();
    [[nodiscard]] bool holds();
    [[nodiscard]] bool in_short_break() const;
    void register_on(const LinkPtr& link, Clock::time_point deadline);
    [[nodiscard]] bool replaces(const Intake& other) const;
    [[nodiscard]] std::int64_t held_before(const std::vector<std::shared_ptr<Intake>>& intakes, bool may_ask) const;
    void confirmed(const LinkPtr& link, const Json& result, std::int64_t held);
    LinkPtr release_link();
    void keep_time();
    void failed(const Error& error);
    void retry();
    void on_packet(const protocol::Packet& packet);
    void disconnected();
    void require_own(const Event& event) const;
    void dropped();
    void on_end(protocol::End end);
    void note_end(std::optional<std::string> text);
    void changed();
    Ticket ticket(std::int64_t generation, std::int64_t number);
    std::int64_t note_share(Event& event);
    void try_to_leave();
    void forget_unfinished();
    void end_if_done();
    [[nodiscard]] bool refuses_now() const;
    void note_group(const std::string& group);
    void tell(const std::optional<protocol::Request>& news);

    Module& module_;
    IntakeSpec spec_;
    Sink sink_;
    std::function<void()> on_end_;
    OnOutcome first_;
    Clock::time_point first_until_;            ///< its deadline; 0: it gets the outcome of the first attempt
    int unreachable_ = 0;                      ///< first attempts that ended so
    std::optional<ConnectionOptions> before_;  ///< the options, while they are being changed
    Backoff backoff_, quick_backoff_;
    std::optional<Clock::time_point> lost_;  ///< since when it has been disconnected
    std::int64_t round_trip_us_ = 0;         ///< of the connection that was lost
    platform::Timer timer_, report_timer_;
    bool report_due_ = false;  ///< a late report is due
    LinkPtr link_;
    std::uint16_t channel_ = 0;
    Stage stage_ = Stage::taking;
    bool connected_ = false;
    int held_ = 0;
    bool held_up_ = false;  ///< it would have reconnected meanwhile
    std::function<void()> on_left_;
    std::optional<Error> problem_;                         ///< why it is not connected
    std::string kind_{};                                   ///< of the sender
    std::int64_t last_lost_us_ = 0, disconnected_us_ = 0;  ///< wall clock
    Clock::time_point lost_at_ = Clock::now();
    std::optional<std::string> end_;            ///< the end and its text
    std::int64_t question_ = 0, answered_ = 0;  ///< the last question about the end, and the last answered
    std::int64_t epoch_ = 0;                    ///< of the registration
    std::int64_t tried_ = 0;                    ///< the first one since the last confirmed one

    std::int64_t sender_epoch_ = 0;
    InputProgress progress_;
    std::deque<std::string> sender_groups_;  ///< of which the sender is a member, by the shares of its last events
    bool replaced_ = false;                  ///< the sender is lost, and other members of its groups do its work
    bool sender_leaves_ = false;             ///< it said that it is being stopped
    bool unacknowledged_ = false;            ///< what arrives is discarded, and the sender is not told

    std::optional<Share> group_;  ///< its standing
    std::int64_t received_ = 0, age_us_ = 0;
    std::array<std::int64_t, endings> ended_{};
};

/// Determines whether all inputs have ended (SPEC.md, section 5.6).
class EndOfInputs {
public:
    using Intakes = std::vector<std::shared_ptr<Intake>>;
    enum class Of {
        drone,      ///< ends when all arrived events have been processed, too
        collector,  ///< ends when the senders have verified it, too
    };
    explicit EndOfInputs(Of whom) : whom_(whom) {}

    /// Network side: a connection has changed. @return  whether the end has changed
    /// @param leaving  closed connections whose work in progress may still have results
    bool look(const Intakes& intakes, const Intakes& leaving = {});
    /// Network side: a collector's end may be out of date, and is withheld until confirm(). @return the number of the
    /// end
    std::int64_t doubt();
    /// Network side: the end still holds, if it has this number. @return whether it does
    bool confirm(std::int64_t end);
    /// The text of the end; nothing as long as something may come. Any thread.
    [[nodiscard]] std::optional<std::string> text() const;

private:
    [[nodiscard]] std::optional<std::string> text_of(const Intakes& intakes) const;

    const Of whom_;
    mutable std::mutex mutex_;
    std::optional<std::string> text_;
    bool sure_ = false;
    std::int64_t number_ = 0;  ///< of the end
};

}  // namespace hive::event
