// The JSON headers of packets as values: what each says, how it is read and written (SPEC.md, sections 4 to 6).
#pragma once

#include <hive/error.hpp>
#include <hive/json.hpp>
#include <hive/protocol/packet.hpp>
#include <hive/transfer.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hive::protocol {

/// The first packet of either end: who is there.
struct Hello {
    std::string name;        ///< of the module in its swarm
    std::string kind;        ///< "face"; "application" for an application
    std::int64_t epoch = 0;  ///< when the module started, microseconds since 1970: a restarted module has a larger one
    std::int64_t pid = 0;
    bool maps = false;  ///< takes bodies in shared memory on this connection
};
Json to_json(const Hello& hello);
Hello hello_from_json(const Json& object);

/// A receiver asks a sender for the events of an output. The channel in the prefix, chosen by the receiver, names the
/// registration on this connection from then on.
struct Registration {
    std::int64_t id = 0;     ///< of the request; the confirmation repeats it
    std::int64_t epoch = 0;  ///< of the registration; each request repeats it
    std::string output;
    std::string receiver;   ///< who: "face" or "face.image"
    std::string accepts;    ///< the media types of its input
    bool stateful = false;  ///< the receiver keeps state between events, so it cannot share
    ConnectionOptions options;
    std::int64_t place = 0;             ///< the place that the sender gave it before; 0: none
    std::optional<std::int64_t> taken;  ///< how many deliveries it has had there
    std::int64_t held = 0;              ///< deliveries that it has not processed yet: it asks for so many fewer
    std::int64_t tried = 0;  ///< epoch of the first of several registrations of which none was confirmed; 0: this one
};
Json to_json(const Registration& registration);
Registration registration_from_json(const Json& object);

/// A receiver asks for more. Both numbers count from the registration, so a lost, late or repeated request is harmless.
struct Request {
    std::int64_t epoch = 0;
    std::int64_t id = 0;                  ///< events asked for so far
    std::int64_t done = 0;                ///< events dealt with so far: the acknowledgement
    std::int64_t worked = 0;              ///< events worked on so far: what was made of them may still be on its way
    std::vector<std::int64_t> back = {};  ///< numbers of deliveries that a group is to give to others
    std::int64_t end = 0;                 ///< the number of a question: does the end still hold? 0: none is asked
    std::int64_t within_ms = most_within_ms;  ///< for how long the answer to that is waited for

    static constexpr std::int64_t most_within_ms = 1000;
};
std::string to_text(const Request& request);
Request request_from_json(const Json& object);
/// The same, quickly where it is written as to_text writes it: there is one for each event.
Request request_from_text(std::string_view text);

/// An output has ended: nothing more will come (SPEC.md, section 5.6).
struct End {
    static constexpr std::size_t most_text = 1024;
    std::string text;           ///< what is lacking; empty: nothing, the regular end of its source
    bool leaves = false;        ///< instead: its drone is being stopped, and need not be waited for
    bool disconnected = false;  ///< instead: an operator ended this registration, and it does not come back by itself
    bool revoked = false;       ///< instead: the output goes on, and the end that was told before no longer holds
    std::int64_t answers = 0;   ///< the last question about the end that this answers; 0: none was asked

    /// Each text once, cut where it is too long.
    void add(const std::string& more);
};
Json to_json(const End& end);
End end_from_json(const Json& object);

/// A segment of shared memory that a sender offers; its descriptor travels with the packet.
struct Segment {
    std::uint32_t id = 0;
    std::uint32_t slots = 0;
    std::uint64_t slot_size = 0;  ///< bytes, a multiple of the page size
};
Json to_json(const Segment& segment);
Segment segment_from_json(const Json& object);
/// Slots are at most a quarter larger than the largest body that the receiver takes.
constexpr std::uint64_t most_slot_size(std::uint64_t most_body) { return most_body + most_body / 4; }

/// One use of one slot of a segment.
struct Slot {
    std::uint32_t segment = 0;
    std::uint32_t index = 0;
    std::uint64_t generation = 0;  ///< counts the uses of the slot

    auto operator<=>(const Slot&) const = default;
};
/// A body in shared memory: what stands in a `reference` packet instead of it.
struct Reference {
    Slot slot;
    std::uint64_t offset = 0;  ///< from the beginning of the slot
    std::uint64_t size = 0;
};
Body to_body(const Reference& reference);
/// Throws Errc::malformed.
Reference reference_from_body(const Body& body);

/// What a `release` packet carries: slots that the receiver uses no longer.
Body to_body(const std::vector<Slot>& slots);
std::vector<Slot> slots_from_body(const Body& body);

/// The answer to a request: a result, or an error.
struct Confirmation {
    std::int64_t id = 0;
    Json result;  ///< an object; meaningful without error
    bool ok = true;
    Errc code{};
    std::string text, advice{};
    std::int64_t time_us = 0;  ///< wall clock of who answers, when it does; 0: not told
};
Json to_json(const Confirmation& confirmation);
Confirmation confirmation_from_json(const Json& object);

}  // namespace hive::protocol
