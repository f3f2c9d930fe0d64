// Measures where events spend their time and what limits their rate, and predicts the effect of changes.
#pragma once

#include <hive/application.hpp>

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hive {

/// The goal of a proposal: more events per second, or a lower age when the last drone has processed them.
enum class Goal { fps, latency };
std::string_view token(Goal goal) noexcept;  // "fps", "latency"

/// One step of the path of an event.
struct Station {
    enum class What {
        source,      ///< makes one event in this time
        waiting,     ///< the newest event waits at its sender until the receiver requests it
        encoding,    ///< of the body, at the sender
        travel,      ///< from one drone to the next
        queue,       ///< at the receiver, of events requested ahead
        work,        ///< in the drone's code
        window,      ///< a limit only: events that may be in flight at once
        processors,  ///< a limit only: of a machine
    };
    What what{};
    std::string at{};      ///< "camera", "face-1, face-2", "camera.image -> face.image", a machine
    double time_us = 0;    ///< of one event, on average
    double max_per_s = 0;  ///< maximum events per second that would reach the last drone; 0: not a limit
};
std::string_view token(Station::What what) noexcept;  // "source"

/// One change, with its predicted effect.
struct Proposal {
    enum class What { worker, window, encoding, transfer, source_rate, halt, machine };
    /// high: every input of the prediction was measured; medium: one was inferred; low: one is unknown.
    enum class Sure { low, medium, high };
    What what{};
    std::string text{};             ///< a sentence without full stop
    std::string command{};          ///< for a shell
    double predicted_per_s = 0;     ///< events per second that the last drone would process
    double predicted_us = 0;        ///< their age then; 0: not known
    std::optional<Station> next{};  ///< what would limit the rate then
    Sure sure{};
    std::string unsure{};  ///< why not high
};
std::string_view token(Proposal::What what) noexcept;  // "worker"
std::string_view token(Proposal::Sure sure) noexcept;  // "high"

/// The path of events from one source to a drone that no other drone receives from.
struct AdvisedLine {
    std::string from, to;             ///< "camera", "face-1, face-2"
    double per_s = 0;                 ///< events per second that the last drone processes
    double latency_us = 0;            ///< their age then; 0: not known
    std::vector<Station> stations{};  ///< in the order of the path
    /// Limits of the rate, the lowest first: the first one is the bottleneck. Empty: no events arrive, or the model
    /// does not explain their rate.
    std::vector<Station> limits{};
    std::vector<Proposal> proposals{};  ///< the best first; empty: nothing known here would help
};

struct Advice {
    Goal goal{};
    std::vector<AdvisedLine> lines;
};

struct AdviceOptions {
    Goal goal = Goal::fps;
    std::chrono::milliseconds time{2000};  ///< of the measurement
};

/// Measures how events pass the drones, and predicts by a model what would help (libhive/docs/architecture.md).
/// Meanwhile it receives the headers of the outputs on the path. If raw images go to another machine, it also requests
/// some as JPEG, to measure their size.
/// @param drones  the last drone of a line; or the first and the last; empty: all lines
/// Throws Errc::not_found when a drone is not running, or no path leads from the first to the last.
Advice advise(Application& application, const std::vector<std::string>& drones = {}, const AdviceOptions& options = {});

/// {"goal", "lines": [{"from", "to", "per_s", "latency_us", "stations": [...], "limits": [...], "proposals": [...]}]}
Json to_json(const Advice& advice);

}  // namespace hive
