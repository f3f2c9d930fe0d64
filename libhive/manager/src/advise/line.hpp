// A line of stages as it was measured, and the model that says what it does. No questions, no clocks.
#pragma once

#include <hive/advise.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hive::advising {

constexpr double second_us = 1e6;

/// Drones that do one step: the source, one drone, or a group that shares it.
struct Stage {
    std::vector<std::string> members{};
    std::map<std::string, int> hosts{};  ///< members, by machine
    std::string host{};                  ///< of the first member, beside which a further one is started
    double per_s = 0;                    ///< of all members: processed; of a source: emitted
    double work_us = 0, cpu_us = 0;      ///< of one event: in the code of a member; processor time of its process
    double queue_us = 0;                 ///< that an event waits at the receiver
    std::optional<double> age_us{};      ///< from the capture of an event until it is emitted
    bool can_share = false;              ///< another member may be started
    // How it receives; of a source nothing.
    std::string from{}, to{};  ///< "camera.image", "face.image" of the first member
    ConnectionOptions options{};
    std::string encoding{};  ///< in use; empty: none
    bool remote = false;     ///< from another machine
    double round_trip_us = 0, encode_us = 0;
    double transit_us = 0;   ///< what else an event takes on the connection; fitted
    double bytes = 0;        ///< of a body as the sender has it; 0: not known
    bool saturated = false;  ///< its sender has more events than it takes

    [[nodiscard]] double size() const { return static_cast<double>(members.size()); }
};

struct MachineLoad {
    double processors = 0, busy = 0;
    double others = 0;                       ///< processors that are busy with something else than the line; fitted
    std::map<std::string, double> drones{};  ///< processors that drones use which are not on the line
    std::string ssh{};                       ///< how it is reached; empty: this machine, or not known
};

/// What an encoding costs, as measured.
struct Encoded {
    double bytes = 0, encode_us = 0;
};

struct Line {
    bool on_demand = false;        ///< the source makes an event when it is requested
    std::string rate_parameter{};  ///< of a live source: "fps"; empty: it has none
    double rate_step = 0.1;        ///< of its values
    std::vector<Stage> stages{};   ///< the source first
    std::map<std::string, MachineLoad> machines{};
    std::map<std::size_t, Encoded> as_jpeg{};  ///< by stage that receives raw images from another machine

    [[nodiscard]] const Stage& last() const { return stages.back(); }
    /// Events per second that the last stage processes.
    [[nodiscard]] double per_s() const { return last().per_s; }
};

/// Infers from rates and ages how long events travel, on demand which stage is saturated, and what others use.
void fit(Line& line);
/// What limits the rate, the lowest first.
std::vector<Station> limits(const Line& line);
/// Events per second that the last stage processes, by the model.
double rate(const Line& line);
/// Does the model say why there are not more? Not if nothing comes, or a drone passes on fewer events than it gets.
bool explains_rate(const Line& line);
/// Age of an event when the last stage has processed it, by the model; absolute only up to what changes leave as it is.
double latency(const Line& line);
/// As measured: how the time is spent.
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
    std::string name{};  ///< of a drone that is halted, or of a machine
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
