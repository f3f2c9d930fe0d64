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

/// One sender's work behind an event: the event was dispatched as a numbered turn, perhaps more than once, and the
/// result made from it is its answer. A group shares turns among its members; a plain receiver of lossless events gets
/// them all.
struct Share {
    std::string of;           ///< "camera.image#workers": output and group; "camera.image": to plain receivers
    std::int64_t epoch = 0;   ///< of that sender
    std::int64_t turn = 0;    ///< counts the events of the group, or of the output, from 1
    int attempt = 1;          ///< counts how often this turn was dispatched
    std::int64_t closed = 0;  ///< of a group: the turns up to this one were answered when this event was sent
    int part = 0;             ///< of the event that was dispatched
    bool each = false;        ///< several plain receivers got it, and each gives its own answer
    std::string to = {};      ///< the input that got it

    [[nodiscard]] bool group() const { return of.find('#') != std::string::npos; }
    /// `of` without its group.
    [[nodiscard]] std::string_view output() const { return std::string_view(of).substr(0, of.find('#')); }
    /// The drone of that output.
    [[nodiscard]] std::string_view sender() const { return output().substr(0, output().rfind('.')); }
    bool operator==(const Share&) const = default;
};

/// Where and when an event was captured. Results inherit it, so that boxes can be matched with their image, age can be
/// measured and order restored.
struct Identity {
    std::string source;              ///< the drone that captured
    std::int64_t epoch = 0;          ///< of the source: a restarted source has a larger one
    std::int64_t sequence = 0;       ///< of the capture, from 1, in that epoch
    std::int64_t captured_us = 0;    ///< wall clock, microseconds since 1970; 0: unknown
    std::int64_t monotonic_us = 0;   ///< the source machine's steady clock at the same moment; 0: unknown
    std::int64_t offset_us = 0;      ///< the source's wall clock minus the local one, as measured on the way
    bool lossless = false;           ///< from a source that produces on demand: no drone on the way may skip it
    int part = 0;                    ///< numbers the events that one drone emits on one output for one input, from 0
    std::vector<Share> shares = {};  ///< the senders' work behind it, outermost first
    std::vector<Hop> hops = {};

    /// The share of the outermost group that works on it; null: it is not shared work.
    [[nodiscard]] const Share* shared_work() const;
};

namespace event {
class Acknowledgement;
}

/// The acknowledgement that an arrived event still owes its sender; copies of the event share it. When no copy is in
/// processing any more, the next event is requested. When no ticket is left, the event is acknowledged: until then its
/// sender would dispatch it again after a failure. A result made from a lossless event carries the ticket of its cause
/// until the next receiver has acknowledged the result.
class Ticket {
public:
    Ticket() = default;
    Ticket(std::shared_ptr<event::Acknowledgement> owed, bool processing);
    Ticket(const Ticket& other);
    Ticket(Ticket&& other) noexcept;
    Ticket& operator=(Ticket other) noexcept;
    ~Ticket();

    [[nodiscard]] bool processing() const { return processing_; }
    /// Lets the next event be requested before this one is acknowledged.
    void stop_processing();
    /// For results made from the event.
    [[nodiscard]] Ticket of_cause() const { return {owed_, false}; }
    /// Null: nothing is left to acknowledge.
    [[nodiscard]] const std::shared_ptr<event::Acknowledgement>& owed() const { return owed_; }

private:
    std::shared_ptr<event::Acknowledgement> owed_;
    bool processing_ = false;
};

/// Cheap to copy: the body is shared.
struct Event {
    Identity identity;
    std::string sender;            ///< the drone that emitted it
    std::string kind;              ///< the kind of that drone: "face"
    std::string output;            ///< of the sender
    std::string input;             ///< where it arrived
    std::string type;              ///< media type of the body, "image/jpeg"
    Json header = Json::object();  ///< as the sender's author wrote it
    std::size_t size = 0;          ///< of the body at the sender, bytes
    bool sized = true;             ///< is `size` known? Not in a notification of a body that was never made
    std::chrono::steady_clock::time_point received{};
    /// A copy without a ticket owes no acknowledgement.
    Ticket ticket;
    /// Empty in a notification. Declared last, so that it is destroyed first: the memory is released together with the
    /// ticket.
    Body body;

    /// Time since the capture, by the wall clocks of the two machines and the measured offset between them; 0 when the
    /// capture time is unknown.
    [[nodiscard]] std::chrono::microseconds age() const;
};

}  // namespace hive
