// The JSON headers of packets as values, and how they are read and written (SPEC.md, sections 4 to 6).
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

/// The first packet of either end: its identity.
struct Hello {
    std::string name;        ///< of the module in its swarm
    std::string kind;        ///< "face"; "application" for an application
    std::int64_t epoch = 0;  ///< when the module started, microseconds since 1970: a restarted module has a larger one
    std::int64_t pid = 0;
    bool maps = false;   ///< accepts bodies in shared memory on this connection
    std::string file{};  ///< the Python file that the module runs, as an absolute path; empty: a program
};
Json to_json(const Hello& hello);
Hello hello_from_json(const Json& object);

/// A receiver subscribes to an output of a sender. The channel in the prefix, chosen by the receiver, identifies the
/// registration on this connection from then on.
struct Registration {
    std::int64_t id = 0;     ///< of the request; the confirmation repeats it
    std::int64_t epoch = 0;  ///< of the registration; each request repeats it
    std::string output;
    std::string receiver;   ///< "face" or "face.image"
    std::string accepts;    ///< the media types of its input
    bool stateful = false;  ///< the receiver keeps state between events, so it cannot share
    ConnectionOptions options;
    std::int64_t place = 0;             ///< the place that the sender assigned before; 0: none
    std::optional<std::int64_t> taken;  ///< number of deliveries received there
    std::int64_t held = 0;              ///< deliveries not processed yet: it requests this many fewer
    std::int64_t tried = 0;             ///< epoch of the first of several unconfirmed registrations; 0: this one
};
Json to_json(const Registration& registration);
Registration registration_from_json(const Json& object);

/// A receiver requests more events. All numbers count from the registration, so a lost, late or repeated request is
/// harmless.
struct Request {
    std::int64_t epoch = 0;
    std::int64_t id = 0;                      ///< events requested so far
    std::int64_t done = 0;                    ///< events finished so far: the acknowledgement
    std::int64_t worked = 0;                  ///< events processed so far: their results may still be in transit
    std::vector<std::int64_t> back = {};      ///< numbers of deliveries that the group has to requeue
    std::int64_t end = 0;                     ///< number of the question whether the end still holds; 0: no question
    std::int64_t within_ms = most_within_ms;  ///< how long the receiver waits for the answer

    static constexpr std::int64_t most_within_ms = 1000;
    static constexpr std::int64_t most_back = 64;
};
std::string to_text(const Request& request);
Request request_from_json(const Json& object);
/// As above, but faster for texts of to_text(): a request is read for each event.
Request request_from_text(std::string_view text);

/// An output has ended: nothing more will come (SPEC.md, section 5.6).
struct End {
    static constexpr std::size_t most_text = 1024;
    std::string text;     ///< what is missing; empty: nothing, the regular end of its source
    bool leaves = false;  ///< instead: its drone is being stopped, so that receivers need not wait for it
    bool disconnected =
        false;             ///< instead: an operator ended this registration, which must not be renewed automatically
    bool revoked = false;  ///< instead: the output continues, and the end sent before is revoked
    std::int64_t answers = 0;  ///< the last question about the end that this answers; 0: none

    /// Joins the texts without repetitions, shortened if too long.
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
/// Slots are at most a quarter larger than the largest body that the receiver accepts.
constexpr std::uint64_t most_slot_size(std::uint64_t most_body) { return most_body + most_body / 4; }

/// One use of one slot of a segment.
struct Slot {
    std::uint32_t segment = 0;
    std::uint32_t index = 0;
    std::uint64_t generation = 0;  ///< counts the uses of the slot

    auto operator<=>(const Slot&) const = default;
};
/// A body in shared memory, as a `reference` packet describes it.
struct Reference {
    Slot slot;
    std::uint64_t offset = 0;  ///< from the beginning of the slot
    std::uint64_t size = 0;
};
Body to_body(const Reference& reference);
/// Throws Errc::malformed.
Reference reference_from_body(const Body& body);

/// The content of a `release` packet: slots that the receiver no longer uses.
Body to_body(const std::vector<Slot>& slots);
std::vector<Slot> slots_from_body(const Body& body);

/// The answer to a request: a result, or an error.
struct Confirmation {
    std::int64_t id = 0;
    Json result;  ///< an object; meaningful without error
    bool ok = true;
    Errc code{};
    std::string text, advice{};
    std::int64_t time_us = 0;  ///< wall clock of the answering module; 0: not given
};
Json to_json(Confirmation confirmation);
Confirmation confirmation_from_json(Json object);

}  // namespace hive::protocol
