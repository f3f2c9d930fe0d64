// A measured line of stages, and the model that predicts its rate and latency. Queries no drone, reads no clock.
#pragma once

#include <hive/advise.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hive::advising {

constexpr double second_us = 1e6;

/// The drones of one step: the source, one drone, or a group that shares the step.
struct Stage {
    std::vector<std::string> members{};
    std::map<std::string, int> hosts{};  ///< members, by machine
    std::string host{};                  ///< of the first member, where a further one would be started
    double per_s = 0;                    ///< of all members: processed; of a source: emitted
    double pass = 1;   ///< events that it sends to the next stage for each that it processes: of a filter, less than 1
    double share = 1;  ///< the part of all events that it processes which comes from the stage before
    double work_us = 0, cpu_us = 0;  ///< of one event: in the code of a member; processor time of its process
    double queue_us = 0;             ///< that an event waits at the receiver
    std::optional<double> age_us{};  ///< from the capture of an event until it is emitted
    bool can_share = false;          ///< another member can be started
    // The connection from which it receives; unset for a source.
    std::string from{}, to{};  ///< "camera.image", "face.image" of the first member
    ConnectionOptions options{};
    std::string encoding{};  ///< in use; empty: none
    bool remote = false;     ///< from another machine
    double round_trip_us = 0, encode_us = 0;
    double transit_us = 0;   ///< other time of an event on the connection; fitted
    double bytes = 0;        ///< of a body as the sender has it; 0: not known
    bool saturated = false;  ///< its sender has more events than it accepts

    [[nodiscard]] double size() const { return static_cast<double>(members.size()); }
};

struct MachineLoad {
    double processors = 0, busy = 0;
    double others = 0;                       ///< processors busy with other work than the line; fitted
    std::map<std::string, double> drones{};  ///< processors used by drones outside of the line
    std::string ssh{};                       ///< its ssh host; empty: this machine, or unknown
};

/// The measured cost of an encoding.
struct Encoded {
    double bytes = 0, encode_us = 0;
};

struct Line {
    double time_us = 0;            ///< for which it was measured: rates are known up to one event in this time
    bool on_demand = false;        ///< the source makes an event when it is requested
    std::string rate_parameter{};  ///< of a live source: "fps"; empty: none
    double rate_step = 0.1;        ///< of its values
    std::vector<Stage> stages{};   ///< the source first
    std::map<std::string, MachineLoad> machines{};
    std::map<std::size_t, Encoded> as_jpeg{};  ///< by stage that receives raw images from another machine

    [[nodiscard]] const Stage& last() const { return stages.back(); }
    /// Events per second that the last stage processes.
    [[nodiscard]] double per_s() const { return last().per_s; }
};

/// Infers from rates and ages how long events travel, which stage is saturated (on demand), and how many processors
/// others use.
void fit(Line& line);
/// Events that reach the last stage for each that stage i processes; of the source, for each that it emits.
double through(const Line& line, std::size_t i);
/// The limits of the rate, the lowest first, as events per second that the last stage processes.
std::vector<Station> limits(const Line& line);
/// Events per second that the last stage processes, by the model.
double rate(const Line& line);
/// Does the model explain the rate? Not if no events arrive.
bool explains_rate(const Line& line);
/// Age of an event when the last stage has processed it, by the model; only its differences between changes are exact.
double latency(const Line& line);
/// The measured time of each step.
std::vector<Station> stations(const Line& line);
std::optional<double> measured_latency(const Line& line);
/// "face-1, face-2"
std::string names(const Stage& stage);
std::string connection(const Stage& stage);

struct Change {
    Proposal::What what{};
    std::size_t stage = 0;
    int window = 1;
    std::string encoding{};  ///< "raw", "jpeg"
    double fps = 0;
    std::string name{};  ///< of a halted drone, or of a machine
};
/// The line after the change, by the model.
Line changed(Line line, const Change& change);
/// A change that may help, with its predictions, without text and command.
struct Candidate {
    Change change;
    Proposal proposal;
};
/// Those that help by at least 5 % (latency: 10 %), the best first.
std::vector<Candidate> candidates(const Line& line, Goal goal);

}  // namespace hive::advising
