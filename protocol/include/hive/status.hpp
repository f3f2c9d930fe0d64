// What a drone tells of itself (SPEC.md, section 6.4) as values: its outputs, the edges at either end, and why nothing
// moves where nothing does.
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

/// Why nothing moves at an output, an edge or an input. `none`: it moves, or there is nothing to move.
enum class Reason {
    none,
    no_receiver,       ///< output: nobody receives it
    not_asked,         ///< the receiver has not asked for another event
    lane_full,         ///< the connection has not yet taken what was given to it
    held,              ///< lossless events wait for the first receiver
    group_awaited,     ///< a group lost its last member with work to do
    not_acknowledged,  ///< it has worked on what it was sent, and acknowledges none of it
    place_kept,        ///< the receiver was cut off; what is its own waits for it
    lease_running,     ///< every attempt at an event was given out, and somebody may still be working on the last
    halted,            ///< the drone has halted
    backlog,           ///< lossless results wait at an output of the drone, so its inputs ask for nothing
    dialing,           ///< the sender is not connected (yet, or again)
    refused,           ///< the sender refused the registration
    no_input,          ///< the drone has inputs that nothing is connected to
    source_ended,      ///< the source has come to its end
    set_prepared,      ///< the drone has prepared a set for an application, which has not decided yet
    watched,           ///< output: only notifications are received, and nobody asks for bodies
};

/// What became of an event that came to an edge; each has exactly one.
enum class Fate {
    acknowledged,     ///< the receiver has dealt with it
    skipped,          ///< a newer one took its place before the receiver asked
    dropped,          ///< the queue of a streaming receiver was full
    passed_on,        ///< it went to another member of the group, or along with a receiver that changed groups
    abandoned,        ///< given up after failed attempts, or because nobody was left to do it
    lost_connection,  ///< it was under way when the connection broke
    lost_killed,      ///< it was with a receiver that died
    lost_cut_off,     ///< it was with a receiver that fell silent and was cut off
    lost_left,        ///< it was under way when the receiver left
};
inline constexpr std::size_t fates = 9;

std::string_view token(Reason value) noexcept;  // "place_kept"; none: ""
std::string_view token(Fate value) noexcept;    // "lost_killed"

/// The account of one edge or group at the sender: came = the sum of all fates + in flight, always, because only came()
/// and went() change it.
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

/// One receiver of an output, or a group of them, as the sender sees it. It outlives single registrations.
struct EdgeStatus {
    std::string receiver;           ///< "face.image", "app-1234"; of a group: "group NAME"
    bool group = false;             ///< this row is the account of a whole group; its members have rows of their own
    bool connected = false;         ///< it is registered now
    std::int64_t registration = 0;  ///< epoch of the present or last registration; 0 for a group
    ConnectionOptions options{};    ///< of the present or last registration
    std::string encoding{};         ///< how bodies are encoded for it now; empty: as they are
    Ledger events{};
    std::int64_t waiting = 0;               ///< of those in flight: not yet sent
    std::int64_t shared = 0, fallback = 0;  ///< bodies that went through shared memory, and that could not
    Reason why{};
};

struct OutputStatus {
    std::string name, type;
    std::int64_t produced = 0;
    std::int64_t unreceived = 0;  ///< of those: nobody received the output
    std::int64_t last_emitted_us = 0;
    std::vector<EdgeStatus> edges{};
    Reason why{};
};

/// One connection of an input, as the receiver sees it: received = processed + abandoned + duplicates + discarded +
/// dropped + unmatched + queued + in_hand.
struct InputStatus {
    std::string input;
    std::string from{};             ///< "camera.image"
    bool connected = false;         ///< registered with the sender now
    std::int64_t registration = 0;  ///< epoch of the present or last registration
    ConnectionOptions options{};
    std::int64_t received = 0;
    std::int64_t processed = 0;   ///< dealt with by the drone's code
    std::int64_t abandoned = 0;   ///< the drone's code threw
    std::int64_t duplicates = 0;  ///< second answers, refused
    std::int64_t discarded = 0;   ///< not begun when the drone halted, resumed or left; shared work went back
    std::int64_t dropped = 0;     ///< the drone's queue was full
    std::int64_t unmatched = 0;   ///< found no partner at the other inputs
    std::int64_t queued = 0;
    std::int64_t in_hand = 0;  ///< with the drone's code
    std::int64_t last_age_us = 0;
    std::int64_t round_trip_us = 0;    ///< shortest of late, of a sender on another machine; 0: not measured
    std::int64_t clock_offset_us = 0;  ///< the wall clock of that machine minus the own one
    std::string error{};               ///< why it is not connected
    Reason why{};
};

struct MatchingStatus {
    std::vector<std::string> inputs{};
    std::int64_t sets = 0, waiting = 0, unmatched = 0, duplicates = 0;
    std::map<std::string, std::int64_t> missing{};  ///< by input: events of others that found no partner there
};

struct ExceptionStatus {
    std::string code{}, text{}, policy{}, input{};
    std::int64_t time_us = 0;
    std::string source{};
    std::int64_t sequence = 0;
};

/// Of the machine, whatever runs there.
struct MachineStatus {
    std::int64_t processors = 0;
    std::int64_t cpu_us = 0;            ///< of all processors, since the machine started
    std::int64_t memory = 0;            ///< bytes
    std::int64_t memory_available = 0;  ///< bytes of it that programs can get
};

struct Status {
    std::string name, kind;
    std::int64_t pid = 0, epoch = 0;
    State state{};
    ExceptionPolicy policy{};
    std::string condition{};  ///< what the drone says of its world; empty: all is well
    std::int64_t uptime_us = 0, busy_us = 0;
    std::int64_t busy_for_us = 0;  ///< how long the present callback has been running; 0: idle
    std::string callback{};        ///< the input of it, or "main"
    std::int64_t encoding_us = 0;  ///< of the uptime: how long it has been encoding events for receivers
    std::int64_t cpu_us = 0;       ///< processor time of the process, of all its threads
    std::int64_t memory = 0;       ///< bytes that the process has in use
    MachineStatus machine{};
    Reason why{};
    std::int64_t source_events = 0;  ///< how many the present source has in all, to its end; 0: unknown, or no end
    std::vector<OutputStatus> outputs{};
    std::vector<InputStatus> inputs{};
    std::vector<InputStatus> left{};  ///< what connections that were ended had received: one row for each input
    std::vector<MatchingStatus> matching{};
    std::optional<ExceptionStatus> last_exception{};
    std::int64_t rows_left_out = 0;     ///< of inputs, left and edges: more than one answer holds
    std::vector<std::string> places{};  ///< addresses where it is met: "unix:/...", "tcp://cam1:7700"
    std::string swarm{};                ///< which swarm brought it up, and so may end it; empty: it belongs to none
    std::optional<DroneOrder> order{};  ///< what it runs with; empty: it does not tell
};

Json to_json(const EdgeStatus& edge);
Json to_json(const InputStatus& input);
Json to_json(const Status& status);
/// Throws Errc::malformed.
Status status_from_json(const Json& object);

/// What one answer holds: the rows (of inputs, left, and the edges of all outputs, in this order) from number `skip`
/// on, as many as fit into a header; `rows_left_out` says how many follow.
Status page_of(Status status, std::int64_t skip);
std::int64_t rows_listed(const Status& status);
/// Appends the rows of the next page.
void add_page(Status& status, Status page);

}  // namespace hive
