// A round as data: which drones there are, how they are connected, and what is done to them. It follows from the seed
// alone, so a round that failed can be played again.
#pragma once

#include <hive/transfer.hpp>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace hive::mixtures {

inline const std::string source = "source", watcher = "watcher", hearer = "hearer", recorder = "recorder",
                         forker = "fork", joiner = "pair";
inline const std::string liar = "liar-";  ///< begins the names of peers that lie

/// That the source of a round with bodies supports: it leaves out the second half of a body.
inline const std::string half_encoding = "half";

/// Drones side by side, each connected to every drone of the stage before (the first: to the source).
struct Stage {
    std::vector<std::string> drones;
    ConnectionOptions options;  ///< with a group, the drones share; otherwise each gets every event
    int throw_every = 0;        ///< the drones throw on each event whose number it divides; 0: never

    [[nodiscard]] bool shared() const { return !options.group.empty(); }
};

struct Edge {
    std::string sender, receiver;
    ConnectionOptions options;
};

struct Step;

struct Topology {
    bool demand = true;    ///< the source is lossless; otherwise live
    bool ordered = false;  ///< results are collected in order
    bool watched = false;  ///< a further drone takes notifications of the source
    bool fails = false;    ///< any worker may throw
    /// Drones beside the stages: each also receives each event of the source, or the joiner what the forker sends.
    /// Their connections stay.
    std::vector<std::string> bystanders = {};
    std::vector<Stage> stages;

    [[nodiscard]] std::vector<Edge> edges() const;
    [[nodiscard]] std::vector<std::string> drones() const;   ///< all
    [[nodiscard]] std::vector<std::string> workers() const;  ///< of the stages
    [[nodiscard]] std::size_t stage_of(const std::string& worker) const;
    [[nodiscard]] bool is_worker(const std::string& drone) const { return stage_of(drone) < stages.size(); }
    [[nodiscard]] bool is_bystander(const std::string& drone) const
    {
        return std::ranges::count(bystanders, drone) > 0;
    }
    [[nodiscard]] bool may_throw(const Stage& stage) const { return fails || stage.throw_every > 0; }
    /// What a step connects. One that changes options makes of a plain edge a stream (1), or has a worker that is alone
    /// in its stage share where it did not, and the other way round (2).
    [[nodiscard]] Edge edge_of(const Step& step) const;
    /// Port by which a drone sends; of the forker the first.
    [[nodiscard]] static std::string output_of(const std::string& drone)
    {
        return drone == source ? "tick" : drone == forker ? "left" : "result";
    }
    /// Port by which it receives; of the joiner the first.
    [[nodiscard]] static std::string input_of(const std::string& drone)
    {
        return drone == recorder ? "events" : drone == forker ? "in" : drone == joiner ? "left" : "image";
    }
};

enum class Verb {
    feed,          ///< the source may make `number` events more
    connect,       ///< `sender` to `drone`; they may be connected
    change,        ///< the options of that connection: window `number`, and as `second` says (Topology::edge_of)
    disconnect,    ///< `sender` from `drone`
    kill,          ///< SIGKILL, `number` ms after the step before
    start,         ///< after a kill or a stop
    freeze,        ///< SIGSTOP
    thaw,          ///< SIGCONT, not before `number` milliseconds have passed since the freeze
    halt,          ///<
    resume,        ///<
    stop,          ///< by order: it forgets what it was told. `second` 1: a callback hangs, so it is killed
    set_one,       ///< work_ms of one drone
    set_all,       ///< work_ms and most_ms of all workers that run
    set_twice,     ///< two of these at once
    set_and_kill,  ///< one of these, while `drone` is killed
    rest,          ///< nothing: only wait and check
    forget,        ///< `sender` waits no longer for `drone`, which was killed; it comes back by itself when it starts
    replace,  ///< another process takes the drone over, and Meanwhile(`second`) happens, after `number` milliseconds
    connect_all,  ///< all connections in one list, and Meanwhile(`second`) happens to `drone`, after `number` x 0.1 ms
    fail,         ///< the drone's code fails, once, at one of the next events, as Failure(`second`) says
    part,         ///< for `number` ms nothing passes between two machines, or only in one direction (`second` 1, 2)
    // Only on several machines (../soak); no plan draws these.
    cut,          ///< the machine `drone` has no network
    mend,         ///< it has again
    swallow,      ///< what the machine `sender` sends to the machine `drone` vanishes
    let_through,  ///< it arrives again
};
std::string_view token(Verb verb) noexcept;

/// While a drone is replaced, or all are connected.
enum class Meanwhile {
    nothing,
    other_kind,  ///< nothing, but the new one is another program with the same ports
    twice,       ///< it is replaced once more; another application connects all, too
    other_too,   ///< the drone `sender` is replaced as well; a drone is replaced
    kill_old,    ///< or a drone
    kill_new,
    kill_caller,  ///< the process that replaces it; the application that connects gives up
    set_all,      ///< work_ms and most_ms of all workers that run; `number` is the work_ms
};
std::string_view token(Meanwhile meanwhile) noexcept;

/// Of the code of a drone.
enum class Failure {
    throws,
    halts,    ///< it throws, and the policy is `halt`
    crashes,  ///< in the middle of a callback
    hangs,    ///< the callback returns `number` ms later
    lingers,  ///< so it does, and the next steps do not wait for it
};
std::string_view token(Failure failure) noexcept;

struct Step {
    Verb verb{};
    std::string drone = {}, sender = {};
    int number = 0, second = 0;  ///< as the verb says; of a set: work_ms, and most_ms or the other work_ms
    bool settle = false;         ///< afterwards wait until nothing changes any more, and check
};

/// Faults that the simulated world adds to the steps.
namespace fault {
inline const std::string none = "none";                ///< only the steps
inline const std::string bodies = "bodies";            ///< of up to 300 KiB, encoded for some connections
inline const std::string crash_point = "crash-point";  ///< a killed drone dies between two writes of a handler
inline const std::string clocks = "clocks";            ///< the drones are on two machines
inline const std::string clock_step = "clock-step";    ///< the time of day is set, back as well
inline const std::string connect_all = "connect-all";  ///< steps of that name
inline const std::string ends = "ends";                ///< the source ends when it has made what it may
inline const std::string fail = "fail";                ///< steps of that name
inline const std::string forget = "forget";            ///< steps of that name
inline const std::string join = "join";                ///< a drone with two outputs, and one that joins them
inline const std::string lie = "lie";                  ///< peers that are not in the round lie
inline const std::string part = "part";                ///< steps of that name, on two machines
inline const std::string replace = "replace";          ///< steps of that name
inline const std::string silence = "silence";          ///< for a time, one drone does not hear another
inline const std::string two_die = "two-die";          ///< a drone and one that it sends to, within one event's work
inline const std::string unplug = "unplug";            ///< an application loses connections while it connects drones
inline const std::set<std::string> all{bodies, clocks, clock_step, connect_all, crash_point, ends,    fail,  forget,
                                       join,   lie,    part,       replace,     silence,     two_die, unplug};
}  // namespace fault

struct Plan {
    std::uint64_t seed = 0;
    int size = 0;  ///< about how many steps were asked for
    Topology topology;
    std::vector<Step> steps;
    std::set<std::string> faults = {};
};

/// A round of about `steps` steps, and those that mend at the end whatever is broken.
Plan make_plan(std::uint64_t seed, int steps, const std::set<std::string>& faults = {});
/// Of these: for many seeds few or none, for some many. The plan of the same seed and faults does not depend on it.
std::set<std::string> draw_faults(std::uint64_t seed, const std::set<std::string>& faults);
/// The options that make this plan again: "--seed 17 --steps 14 --with part".
std::string options_of(const Plan& plan);
std::string to_text(const Topology& topology);
std::string to_text(const Step& step);

}  // namespace hive::mixtures
