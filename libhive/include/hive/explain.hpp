// Explains why drones emit nothing: what blocks them, with evidence and the command that helps.
#pragma once

#include <hive/application.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hive {

/// One reason why drones stall or are slow.
struct Cause {
    enum class What {
        not_running,
        crashed,          ///< killed by a signal, and not running
        failed,           ///< crashes repeatedly
        suspended,        ///< by SIGSTOP or Ctrl-Z
        no_answer,        ///< running on this machine, but does not answer
        unreachable,      ///< on another machine, and does not answer
        refused,          ///< the drone or a sender refuses the connection: a key, a version, a type
        starting,         ///< not ready yet
        halted,           ///< until it is resumed
        set_prepared,     ///< an application prepared a set and has not committed or aborted it
        throws,           ///< its code throws at each event
        stuck,            ///< its code has been processing one event far longer than usual
        source_ended,     ///< the file has been read to its end
        condition,        ///< a condition that the drone reports, such as an unplugged camera
        not_connected,    ///< nothing is connected to its inputs, or the two are not connected
        wrong_way,        ///< the connection exists in the other direction, or would fit only that way
        wrong_types,      ///< no output of the sender fits an input of the receiver
        dialing,          ///< the sender is running, but the receiver cannot reach it
        held,             ///< lossless events wait for a receiver of bodies
        no_receiver,      ///< its outputs have no receiver
        watched,          ///< only headers are received, and a source on demand waits for a receiver of bodies
        receiver_away,    ///< events wait for a receiver that was cut off, or for a group without members
        waits,            ///< a receiver does not request, or does not acknowledge
        slow,             ///< the sender waits while this drone processes
        slow_connection,  ///< transfers events more slowly than they are produced
        small_window,     ///< the round trip is long, and few events are requested ahead
        copied,           ///< shared memory has no room for the bodies, so they are copied
        encoder,          ///< the sender encodes all the time, and skips events meanwhile
        clock,            ///< the clocks of the two machines differ by more than a second
        load,             ///< the processors of the machine are busy all the time
        memory,           ///< little of the machine's memory is left
        same_name,        ///< drones on several machines have one name
        emits_nothing,    ///< receives events and emits none
        silent_source     ///< emits nothing, and does not report why
    };
    What what{};
    std::string drone{};       ///< that has the problem
    std::string connection{};  ///< "camera.image -> face.image"; empty: none
    std::string text{};        ///< a sentence without full stop
    std::string evidence{};    ///< a count, an age, a state; may be empty
    std::string command{};     ///< for a shell; may be empty
    bool blocks = true;        ///< false: the drones keep running, slower or without a part
};
std::string_view token(Cause::What what) noexcept;  // "not_running"

/// How fast events pass one drone.
struct Flow {
    std::string drone;
    double received_per_s = 0;  ///< from all inputs
    double emitted_per_s = 0;   ///< by all outputs, with a receiver or without
    std::int64_t age_us = 0;    ///< from the capture of the newest event to its arrival; 0: no input
    bool operator==(const Flow&) const = default;
};

struct Explanation {
    std::vector<Cause> causes;  ///< blocking ones first; of these, the one nearest to the source
    std::vector<Flow> flows;    ///< of the drones on the path that answer, sources first

    [[nodiscard]] bool blocked() const { return !causes.empty() && causes.front().blocks; }
    [[nodiscard]] bool has(Cause::What what) const;
};

/// Queries drones twice, 300 ms apart, upstream from the outputs (or all outputs of a drone) to the sources, and those
/// for which they wait; a cause must show both times. Waits for each answer at most the application's timeout.
/// @param ends  empty: all drones, and those that crashed; unused ones, such as an unconnected drone, come last
/// Throws Errc::invalid_argument when several drones have a name.
Explanation explain(Application& application, const std::vector<Endpoint>& ends = {});
/// The same for all drones, from the answers of two earlier queries of all. Queries only drones that the second lacks.
Explanation explain_answers(Application& application, std::vector<StatusAnswer> first,
                            std::vector<StatusAnswer> second);
/// The same for events from one drone to another, including whether the two are connected.
Explanation explain(Application& application, const Endpoint& sender, const Endpoint& receiver);

/// The window that would transfer a live stream without skipping: each event is requested a round trip ahead. Nothing
/// if the current window is wide enough, or no event was skipped.
std::optional<int> window_that_helps(const EdgeStatus& edge, const InputStatus& input);

/// The first causes in one line: "camera has halted; try: hivectl resume camera"; empty: nothing blocks or slows them.
/// Causes that only slow down are named if none blocks.
std::string to_text(const Explanation& explanation);
/// {"text": as above, "causes": [...], "flows": [...]}, with the fields above.
Json to_json(const Explanation& explanation);
Json to_json(const Cause& cause);

}  // namespace hive
