// Why nothing comes from drones: what holds them up, with evidence and the command that helps.
#pragma once

#include <hive/application.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hive {

/// One thing that holds up drones, or slows them down.
struct Cause {
    enum class What {
        not_running,
        crashed,          ///< died of a signal, and does not run
        failed,           ///< crashes again and again
        suspended,        ///< by SIGSTOP or Ctrl-Z
        no_answer,        ///< runs on this machine, and does not answer
        unreachable,      ///< does not answer from another machine
        refused,          ///< the drone or a sender refuses the connection: a key, a version, a type
        starting,         ///< not ready yet
        halted,           ///< until it is resumed
        set_prepared,     ///< an application prepared a set and has not decided it yet
        throws,           ///< its code throws at each event
        stuck,            ///< its code has been working on one event far longer than usual
        source_ended,     ///< the file has been read to its end
        condition,        ///< what the drone reports of its world: a camera that is unplugged
        not_connected,    ///< nothing is connected to its inputs, or the two are not connected
        wrong_way,        ///< the connection exists in the other direction, or would fit only so
        wrong_types,      ///< no output of the sender fits an input of the receiver
        dialing,          ///< the sender runs, and the receiver does not reach it
        held,             ///< lossless events wait for a receiver of bodies
        no_receiver,      ///< nobody receives what it makes
        watched,          ///< only headers are received, and a source on demand waits for a receiver of bodies
        receiver_away,    ///< events wait for a receiver that was cut off, or for a group without members
        waits,            ///< a receiver does not ask, or does not acknowledge
        slow,             ///< the sender waits as long as this drone works
        slow_connection,  ///< takes events more slowly than they are made
        small_window,     ///< the round trip is long, and few events are requested ahead
        copied,           ///< shared memory does not take the bodies, so they are copied
        encoder,          ///< the sender encodes all the time, and skips events meanwhile
        clock,            ///< the clocks of the two machines differ by more than a second
        load,             ///< the processors of the machine are busy all the time
        memory,           ///< little of the machine's memory is left
        same_name,        ///< drones on several machines have one name
        emits_nothing,    ///< takes events and emits none
        silent_source     ///< emits nothing, and does not report why
    };
    What what{};
    std::string drone{};       ///< where it lies
    std::string connection{};  ///< "camera.image -> face.image"; empty: none
    std::string text{};        ///< a sentence without full stop
    std::string evidence{};    ///< a count, an age, a state; may be empty
    std::string command{};     ///< that helps, for a shell; may be empty
    bool blocks = true;        ///< false: the drones go on, more slowly or without a part
};
std::string_view token(Cause::What what) noexcept;  // "not_running"

/// How fast events pass one drone.
struct Flow {
    std::string drone;
    double received_per_s = 0;  ///< taken from all inputs
    double emitted_per_s = 0;   ///< by all outputs, with a receiver or without
    std::int64_t age_us = 0;    ///< from the capture of the newest event to its arrival; 0: it has no input
    bool operator==(const Flow&) const = default;
};

struct Explanation {
    std::vector<Cause> causes;  ///< those that block first; of these, the one nearest to the source
    std::vector<Flow> flows;    ///< of the drones on the way that answer, sources first

    [[nodiscard]] bool blocked() const { return !causes.empty() && causes.front().blocks; }
    [[nodiscard]] bool has(Cause::What what) const;
};

/// Looks twice, 300 ms apart, against the direction of the events, from the outputs (or all outputs of a drone) to the
/// sources, and at those for which they wait; only what both looks show is a cause. Waits for each answer as long as
/// the application's timeout.
/// @param ends  empty: all drones, and those that crashed; what nobody needs, such as an unconnected drone, comes last
/// Throws Errc::invalid_argument when a name means several drones.
Explanation explain(Application& application, const std::vector<Endpoint>& ends = {});
/// The same for what comes from one drone to another one, and whether they are connected at all.
Explanation explain(Application& application, const Endpoint& sender, const Endpoint& receiver);

/// The window with which a video would come through: of so many events per second, each is requested a round trip
/// ahead. Nothing if the present one is wide enough, or no event was skipped.
std::optional<int> window_that_helps(const EdgeStatus& edge, const InputStatus& input);

/// The first causes in one line: "camera has halted; try: hivectl resume camera"; empty: nothing holds them up. Those
/// that only slow down are there if nothing blocks.
std::string to_text(const Explanation& explanation);
/// {"text": as above, "causes": [...], "flows": [...]}, with the fields above.
Json to_json(const Explanation& explanation);
Json to_json(const Cause& cause);

}  // namespace hive
