// An input's connection to one output of another module: registers, asks, acknowledges, and comes back after a loss.
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
    transport::Address address = {};  ///< where it is met
    std::string input = {};           ///< of this module
    std::string receiver = {};        ///< this end as the sender knows it: "face.image"
    std::string accepts = "*/*";
    bool stateful = false;
    ConnectionOptions options = {};
};

/// How far the turns of a group are, as one of its members knows it.
struct Standing {
    Share share;                     ///< its turn: the last that anybody was given, as far as the member knows
    std::vector<std::int64_t> open;  ///< turns that the member has in hand
};

/// Network side; what has a ticket may be dropped on any thread.
class Intake : public std::enable_shared_from_this<Intake> {
public:
    using Sink = std::function<void(Event&&)>;

    /// @param on_end  called when something has changed that EndOfInputs looks at
    Intake(
        Module& module, IntakeSpec spec, Sink sink, std::function<void()> on_end = [] {});

    /// Counts an event that came in another way than over this connection, and hands it on.
    void accept(Event event);
    /// Dials and registers. `first` hears how the first attempt went; later losses are repaired without a word.
    void start(OnOutcome first);
    /// Goes on with other options at the same place, so that nothing is lost and nothing comes twice. If the sender
    /// refuses them, it goes on with those that it had. For one that is connected and no member of a group, nor is to
    /// be one.
    void change(const ConnectionOptions& options, OnOutcome on_outcome);
    /// No event comes after this. What is in hand of shared or lossless work is ended first; then it deregisters.
    /// `left` is called when the sender has confirmed, or cannot.
    void stop(std::function<void()> left = [] {});
    /// After stop(): what is in hand is waited for no longer, its sender may give it to others.
    void leave_now();
    void acknowledge_held();
    /// Another process goes on in its place: the sender is told what is done and nothing of an end, and gives the rest
    /// to that one. After this nothing is acknowledged.
    void hand_over();
    /// Is something worked on whose results nobody has acknowledged yet?
    [[nodiscard]] bool owes() const { return progress_.owes(); }
    /// Asks for what may be asked for now.
    void flush();
    /// Another one is being made that will take its place: until it is let go on, it does not come back to the sender,
    /// which would take it for the newer of the two.
    void hold() { ++held_; }
    void let_go_on();
    void link_closed(const Link& link);
    /// An event was worked on, or is done with; `ending` says how.
    void heard(std::int64_t generation, std::int64_t number, bool worked, bool done, std::optional<Ending> ending);

    [[nodiscard]] const IntakeSpec& spec() const noexcept { return spec_; }
    [[nodiscard]] bool connected() const noexcept { return connected_; }
    [[nodiscard]] bool stopped() const noexcept { return stage_ != Stage::taking; }
    /// What the sender, or who was met in its place, has against this connection, if that is why it is not connected.
    [[nodiscard]] std::optional<Error> refusal() const;
    /// What the sender said about its end, if it has come to it.
    [[nodiscard]] const std::optional<std::string>& ended() const noexcept { return end_; }
    /// Asks the sender whether that still holds. @param within  what the answer is waited for
    void ask_end(std::chrono::milliseconds within);
    /// Was it asked, and may still answer? One that is lost may come back with another source.
    [[nodiscard]] bool unsure() const;
    /// Has everything that came been worked on?
    [[nodiscard]] bool all_worked() const noexcept { return !progress_.works(); }
    /// Does the sender know, or is it not there, that this one is gone?
    [[nodiscard]] bool has_left() const noexcept { return stage_ == Stage::left; }
    /// May the end of the other inputs ignore this sender, because it is lost or stopped (SPEC.md, section 5.6)?
    [[nodiscard]] bool gone_for_good() const;
    /// What is lacking if the end did not wait for this sender; empty: nothing.
    [[nodiscard]] std::string lacks() const;
    /// `queued` is left to whoever knows the queue: until then it counts as in hand.
    [[nodiscard]] InputStatus status() const;
    /// Of the group that it is a member of.
    [[nodiscard]] std::optional<Standing> standing() const;

private:
    enum class Stage {
        taking,
        draining,  ///< what is in hand is finished
        leaving,   ///< the sender was told, or could not be
        left,
    };
    void attempt();
    [[nodiscard]] bool holds();
    [[nodiscard]] bool in_short_break() const;
    void register_on(const LinkPtr& link, Clock::time_point deadline);
    void confirmed(const LinkPtr& link, const Json& result, std::int64_t held);
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
    void end_if_done();
    [[nodiscard]] bool refuses_now() const;
    void tell(const std::optional<protocol::Request>& news);

    Module& module_;
    IntakeSpec spec_;
    Sink sink_;
    std::function<void()> on_end_;
    OnOutcome first_;
    std::optional<ConnectionOptions> before_;  ///< the options, while they are being changed
    Backoff backoff_, quick_backoff_;
    std::optional<Clock::time_point> lost_;  ///< since when it has been cut off
    std::int64_t round_trip_us_ = 0;         ///< of the connection that was lost
    platform::Timer timer_;
    LinkPtr link_;
    std::uint16_t channel_ = 0;
    Stage stage_ = Stage::taking;
    bool connected_ = false;
    int held_ = 0;
    bool held_up_ = false;  ///< it would have come back meanwhile
    std::function<void()> on_left_;
    std::optional<Error> problem_;  ///< why it is not connected
    Clock::time_point lost_at_ = Clock::now();
    std::optional<std::string> end_;            ///< nothing more will come, and what is said about that
    std::int64_t question_ = 0, answered_ = 0;  ///< the last one about the end, and the last that was answered
    std::int64_t epoch_ = 0;                    ///< of the registration
    std::int64_t tried_ = 0;                    ///< the first one since the last that was confirmed

    std::int64_t sender_epoch_ = 0;
    InputProgress progress_;
    bool of_member_ = false;      ///< the last event was the work of a group that the sender is a member of
    bool sender_leaves_ = false;  ///< it said that it is being stopped

    std::optional<Share> group_;  ///< its standing
    std::int64_t received_ = 0, age_us_ = 0;
    std::array<std::int64_t, endings> ended_{};
};

/// Whether all inputs have come to their end (SPEC.md, section 5.6).
class EndOfInputs {
public:
    using Intakes = std::vector<std::shared_ptr<Intake>>;
    enum class Of {
        drone,      ///< when all that came has been worked on, too
        collector,  ///< when the senders have made sure of it, too
    };
    explicit EndOfInputs(Of whom) : whom_(whom) {}

    /// Network side: a connection has changed. @return  whether the end has changed
    /// @param leaving  connections that were ended, of which the results of what is still worked on may be to come
    bool look(const Intakes& intakes, const Intakes& leaving = {});
    /// Network side: of a collector, the end may be out of date, and is unsaid until confirm(). @return  which end it
    /// is
    std::int64_t doubt();
    /// Network side: it still holds, if it is this one. @return  whether it does
    bool confirm(std::int64_t end);
    /// What is said about the end; nothing as long as something may come. Any thread.
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
