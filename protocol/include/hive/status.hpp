// A drone's status (SPEC.md, section 6.4) as values: its outputs, the edges at either end, and stall reasons.
#pragma once

#include <hive/drone_order.hpp>
#include <hive/json.hpp>
#include <hive/transfer.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hive {

/// Why an output, an edge or an input is stalled. `none`: it is not, or has nothing to send.
enum class Reason {
    none,
    no_receiver,       ///< output: no receivers
    not_asked,         ///< the receiver has not asked for another event
    lane_full,         ///< the connection's send queue is full
    held,              ///< lossless events wait for the first receiver
    group_awaited,     ///< a group lost its last member and has work pending
    not_acknowledged,  ///< the receiver has processed what it was sent, but acknowledges none of it
    place_kept,        ///< the receiver was disconnected; its events wait for it
    lease_running,     ///< every attempt at an event was dispatched, and a member may still be working on the last one
    halted,            ///< the drone has halted
    backlog,           ///< lossless results wait at an output of the drone, so its inputs request nothing
    dialing,           ///< the sender is not connected (yet, or again)
    refused,           ///< the sender refused the registration
    no_input,          ///< the drone has inputs without a connection
    source_ended,      ///< the source has ended
    set_prepared,      ///< the drone has prepared a set that an application has not decided yet
    watched,           ///< output: every receiver takes notifications only
};

/// The outcome of an event at an edge; each event has exactly one.
enum class Fate {
    acknowledged,     ///< the receiver has processed it
    skipped,          ///< replaced by a newer event before the receiver requested it
    dropped,          ///< the queue of a streaming receiver was full
    passed_on,        ///< it went to another member of the group, or moved with a receiver that changed groups
    abandoned,        ///< given up after failed attempts, or for lack of members
    lost_connection,  ///< in transit when the connection broke
    lost_killed,      ///< at a receiver that crashed
    lost_cut_off,     ///< at a receiver that was disconnected for inactivity
    lost_left,        ///< in transit when the receiver left
};
inline constexpr std::size_t fates = 9;

std::string_view token(Reason value) noexcept;  // "place_kept"; none: ""
std::string_view token(Fate value) noexcept;    // "lost_killed"
/// Was the delivery of such an event promised? Not of one that was skipped, or in transit when the receiver left.
bool is_loss(Fate fate) noexcept;

/// The counters of one edge or group at the sender. Invariant: came = the sum of all fates + in flight.
class Ledger {
public:
    void came(std::int64_t events = 1) noexcept { came_ += events; }
    void went(Fate fate, std::int64_t events = 1) noexcept
    {
        went_[static_cast<std::size_t>(fate)] += events;
        gone_ += events;
    }

    [[nodiscard]] std::int64_t total() const noexcept { return came_; }
    [[nodiscard]] std::int64_t of(Fate fate) const noexcept { return went_[static_cast<std::size_t>(fate)]; }
    [[nodiscard]] std::int64_t lost() const noexcept;
    [[nodiscard]] std::int64_t in_flight() const noexcept { return came_ - gone_; }
    bool operator==(const Ledger&) const = default;

private:
    std::int64_t came_ = 0, gone_ = 0;
    std::array<std::int64_t, fates> went_{};
};

/// The sender's counters for one receiver of an output, or for a group. They outlive single registrations.
struct EdgeStatus {
    std::string receiver;           ///< "face.image", "app-1234"; of a group: "group NAME"
    bool group = false;             ///< this row counts for a whole group; its members have their own rows
    bool connected = false;         ///< it is registered now
    std::int64_t registration = 0;  ///< epoch of the current or last registration; 0 for a group
    ConnectionOptions options{};    ///< of the current or last registration
    std::string encoding{};         ///< how bodies are encoded for it now; empty: unencoded
    Ledger events{};
    std::int64_t waiting = 0;               ///< the part of those in flight that is not sent yet
    std::int64_t shared = 0, fallback = 0;  ///< bodies sent through shared memory, and bodies that could not be
    std::int64_t last_lost_us = 0;          ///< wall clock of the newest loss (is_loss); 0: none
    Reason why{};
};

struct OutputStatus {
    std::string name, type;
    std::int64_t produced = 0;
    std::int64_t unreceived = 0;  ///< of those: emitted without a receiver
    std::int64_t last_emitted_us = 0;
    bool lossless = false;  ///< the newest event must reach each receiver: its source produces on demand
    std::vector<EdgeStatus> edges{};
    Reason why{};
};

/// The receiver's counters for one connection of an input: received = processed + abandoned + duplicates + discarded +
/// dropped + unmatched + queued + in_hand.
struct InputStatus {
    std::string input;
    std::string from{};             ///< "camera.image"
    std::string address{};          ///< of the sender, if it is on another machine: "tcp://cam1:7700"
    std::string kind{};             ///< of the sender, when it was last connected; empty: never
    bool connected = false;         ///< registered with the sender now
    std::int64_t registration = 0;  ///< epoch of the current or last registration
    ConnectionOptions options{};
    std::int64_t received = 0;
    std::int64_t processed = 0;   ///< processed by the drone's code
    std::int64_t abandoned = 0;   ///< the drone's code threw
    std::int64_t duplicates = 0;  ///< events and results that came before, rejected
    std::int64_t discarded = 0;   ///< not started when the drone halted, resumed or left; shared work was requeued
    std::int64_t dropped = 0;     ///< the drone's queue was full
    std::int64_t unmatched = 0;   ///< without a partner at the other inputs
    std::int64_t queued = 0;
    std::int64_t in_hand = 0;       ///< in progress in the drone's code
    std::int64_t last_lost_us = 0;  ///< wall clock of the newest abandoned or dropped event; 0: none
    std::int64_t work_p99_us = 0;   ///< 99 % of the last events took the drone's code at most this long; 0: none yet
    std::int64_t last_age_us = 0;
    std::int64_t round_trip_us = 0;    ///< shortest recent one, to a sender on another machine; 0: not measured
    std::int64_t clock_offset_us = 0;  ///< that machine's wall clock minus the local one
    std::int64_t disconnected_us = 0;  ///< wall clock of the end of the last connection; 0: connected, or never was
    std::string error{};               ///< why it is not connected
    Reason why{};
};

struct MatchingStatus {
    std::vector<std::string> inputs{};
    std::int64_t sets = 0, waiting = 0, unmatched = 0, duplicates = 0;
    std::map<std::string, std::int64_t> missing{};  ///< by input: events of other inputs without a partner there
};

struct ExceptionStatus {
    std::string code{}, text{}, policy{}, input{};
    std::int64_t time_us = 0;
    std::string source{};
    std::int64_t sequence = 0;
};

struct HaltStatus {
    std::string by{};  ///< who asked for it: "hivectl-4711 (pid 4711)"; empty: the drone itself
    std::int64_t time_us = 0;
};

/// Usage of the whole machine.
struct MachineStatus {
    std::int64_t processors = 0;
    std::int64_t cpu_us = 0;  ///< of all processors, since the machine started
    /// Bytes, and those of them that are available to programs: of the machine, or of a control group of the drone (a
    /// container, a slice) if that has fewer available.
    std::int64_t memory = 0, memory_available = 0;
    bool memory_limited = false;  ///< `memory` is the limit of a control group
};

struct Status {
    std::string name, kind;
    std::int64_t pid = 0, epoch = 0;
    State state{};
    ExceptionPolicy policy{};
    std::string condition{};  ///< set by the drone's code; empty: all is well
    std::int64_t uptime_us = 0, busy_us = 0;
    std::int64_t busy_for_us = 0;  ///< how long the current callback has been running; 0: idle
    std::string callback{};        ///< its input, or "main"
    std::int64_t encoding_us = 0;  ///< time spent encoding events for receivers
    std::int64_t cpu_us = 0;       ///< processor time of the process, of all its threads
    std::int64_t memory = 0;       ///< bytes that the process has in use
    MachineStatus machine{};
    Reason why{};
    std::int64_t source_events = 0;  ///< total of the current source; 0: unknown or unlimited
    std::vector<OutputStatus> outputs{};
    std::vector<InputStatus> inputs{};
    std::vector<InputStatus> left{};  ///< counters of closed connections and of puts: one row per input
    std::vector<MatchingStatus> matching{};
    std::optional<ExceptionStatus> last_exception{};
    std::optional<HaltStatus> halted{};  ///< empty: it accepts events
    std::int64_t rows_left_out = 0;      ///< rows of inputs, left and edges beyond this answer
    std::vector<std::string> places{};   ///< addresses where it is reachable: "unix:/...", "tcp://cam1:7700"
    std::string swarm{};                 ///< the swarm that started it and may stop it; empty: none
    std::optional<DroneOrder> order{};   ///< its configuration; empty: not reported
    std::string version{};               ///< of its Hive, as in its interface; empty: not reported
};

Json to_json(const EdgeStatus& edge);
Json to_json(const InputStatus& input);
Json to_json(const Status& status);
/// Throws Errc::malformed.
Status status_from_json(const Json& object);

/// The page of one answer: the rows (of inputs, left, and the edges of all outputs, in this order) from number `skip`
/// on, as many as fit into a header; `rows_left_out` says how many follow.
Status page_of(Status status, std::int64_t skip);
std::int64_t rows_listed(const Status& status);
/// Appends the rows of the next page.
void add_page(Status& status, Status page);

}  // namespace hive
