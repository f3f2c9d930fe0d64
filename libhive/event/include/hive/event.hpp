// An event as user code sees it: what happened, where and when it began, and its bytes.
#pragma once

#include <hive/body.hpp>
#include <hive/json.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace hive {

/// Time spent by one drone on the way of an event.
struct Hop {
    std::string drone;
    std::int64_t wait_us = 0;  ///< from arrival until its code began
    std::int64_t work_us = 0;  ///< from then until it emitted
};

/// One sender's work behind an event: the event was given out as a numbered turn, perhaps more than once, and what is
/// made of it is its answer. A group shares turns among its members; a plain receiver of lossless events has them all.
struct Share {
    std::string of;           ///< "camera.image#workers": output and group; "camera.image": to plain receivers
    std::int64_t epoch = 0;   ///< of that sender
    std::int64_t turn = 0;    ///< counts the events of the group, or of the output, from 1
    int attempt = 1;          ///< counts how often this turn was given out
    std::int64_t closed = 0;  ///< of a group: this turn and all before it had their answer when this one went out
    int part = 0;             ///< of the event that was given out
    bool each = false;        ///< several plain receivers got it, and each gives an answer of its own
    std::string to = {};      ///< the input that got it

    [[nodiscard]] bool group() const { return of.find('#') != std::string::npos; }
    bool operator==(const Share&) const = default;
};

/// Where and when an event began. Results inherit it, so boxes and picture can be matched, age can be measured, order
/// restored.
struct Identity {
    std::string source;              ///< the drone that captured
    std::int64_t epoch = 0;          ///< of the source: a restarted source has a larger one
    std::int64_t sequence = 0;       ///< of the capture, from 1, in that epoch
    std::int64_t captured_us = 0;    ///< wall clock, microseconds since 1970; 0: unknown
    std::int64_t monotonic_us = 0;   ///< the source machine's steady clock at the same moment; 0: unknown
    std::int64_t offset_us = 0;      ///< the source's wall clock minus the one here, as it was measured on the way
    bool lossless = false;           ///< from a source that produces on demand: nobody on the way may skip it
    int part = 0;                    ///< numbers the events that one drone emits on one output for one input, from 0
    std::vector<Share> shares = {};  ///< whose work stands behind it, outermost first
    std::vector<Hop> hops = {};

    /// The outermost group that works on it; null: it is not shared work.
    [[nodiscard]] const Share* shared_work() const;
};

namespace event {
class Acknowledgement;
}

/// What is owed to the sender of an event that has arrived; copies of the event share it. When no copy says that it is
/// processed, the next event is asked for. When no ticket is left, the event is acknowledged: until then its sender
/// would give it out again. What is made of a lossless event carries the ticket of its cause until the next receiver
/// has acknowledged that.
class Ticket {
public:
    Ticket() = default;
    Ticket(std::shared_ptr<event::Acknowledgement> owed, bool processing);
    Ticket(const Ticket& other);
    Ticket(Ticket&& other) noexcept;
    Ticket& operator=(Ticket other) noexcept;
    ~Ticket();

    [[nodiscard]] bool processing() const { return processing_; }
    /// The next event may be asked for, although this one is not acknowledged.
    void stop_processing();
    /// For what is made of the event.
    [[nodiscard]] Ticket of_cause() const { return {owed_, false}; }
    /// Null: nothing is owed.
    [[nodiscard]] const std::shared_ptr<event::Acknowledgement>& owed() const { return owed_; }

private:
    std::shared_ptr<event::Acknowledgement> owed_;
    bool processing_ = false;
};

/// Cheap to copy: the body is shared.
struct Event {
    Identity identity;
    std::string sender;            ///< the drone that emitted it
    std::string kind;              ///< what that drone is: "face"
    std::string output;            ///< of the sender
    std::string input;             ///< where it arrived
    std::string type;              ///< media type of the body, "image/jpeg"
    Json header = Json::object();  ///< what the sender's author put in
    std::size_t size = 0;          ///< of the body at the sender, bytes
    bool sized = true;             ///< is `size` known? Not in a notification of a body that nobody wanted to be made
    std::chrono::steady_clock::time_point received{};
    /// Without it the copy is only looked at.
    Ticket ticket;
    /// Empty in a notification. Declared last, so that it goes first: the memory is given back together with the
    /// ticket.
    Body body;

    /// Since the capture, by the wall clocks of the two machines and what was measured between them; 0 when nobody
    /// knows when that was.
    [[nodiscard]] std::chrono::microseconds age() const;
};

}  // namespace hive
