// What a swarm owes to whoever collects its results, and what orders have excused it from.
#pragma once

#include "condition.hpp"

#include <hive/event.hpp>

#include <chrono>
#include <limits>
#include <optional>

namespace hive::mixtures {

/// What came of an event of the source: a result, or the exception that came instead.
struct Outcome {
    bool failed = false;
    std::string sender;
    std::string text;  ///< of an exception: its code and text
    std::int64_t epoch = 0, sequence = 0;
    std::vector<std::string> hops;  ///< the drones that the event went through, oldest first
    std::int64_t index = 0;         ///< of a result: its number in the run of the source; 0: its header does not say
};
std::string to_text(const Outcome& outcome);
/// @param failed  it came of an exceptions output
Outcome outcome_of(const Event& event, bool failed);

class Model {
public:
    /// @param collectors  of the results
    explicit Model(const Topology& topology, std::int64_t collectors = 1);

    using Time = std::chrono::steady_clock::time_point;
    /// To be called before a step is done: an order, or the time that a drone has been dead, may end what was promised.
    void before(const Step& step, Time now = {});
    /// What the drones were told to receive: sender and receiver.
    [[nodiscard]] const std::set<std::pair<std::string, std::string>>& wanted() const { return condition_.wanted(); }
    /// Those that have halted.
    [[nodiscard]] std::set<std::string> halted() const;
    /// What is excused now, until the edges of the drone are whole again; "" stands for all drones.
    [[nodiscard]] std::vector<std::string> excused() const;
    /// They are: the source had produced so many events by then.
    void whole(const std::string& drone, std::int64_t epoch, std::int64_t produced);

    /// Says what is wrong with it: a second answer, or one out of order.
    std::optional<std::string> came(const Outcome& outcome);
    /// Of a source on demand at rest: what has not come, of the events that it has produced in this epoch.
    [[nodiscard]] std::vector<std::string> missing(std::int64_t epoch, std::int64_t produced) const;
    /// Must the event have come by way of these bystanders?
    [[nodiscard]] bool owes(const std::vector<std::string>& bystanders, std::int64_t epoch,
                            std::int64_t sequence) const;
    /// At most, of an event.
    [[nodiscard]] std::int64_t max_results() const { return std::ssize(ways()); }
    /// Those that have come of this event, and that any other collector must have got.
    [[nodiscard]] std::int64_t results_owed(std::int64_t epoch, std::int64_t sequence) const;
    /// Has any exception come?
    [[nodiscard]] bool any_failed() const;
    /// How many exceptions came of drones before the last stage.
    [[nodiscard]] std::int64_t failed_early() const;
    /// Was anything excused so far, or has a drone begun anew after it was stopped, whose exceptions wait for nobody?
    [[nodiscard]] bool was_excused() const { return began_anew_ || !excuses_.empty(); }

private:
    using Way = std::vector<std::string>;  ///< the drones of the plain stages, each of which gives a result of its own
    static constexpr auto open = std::numeric_limits<std::int64_t>::max();
    struct Excuse {
        std::string drone;
        std::int64_t epoch, until;
    };
    struct Came {
        Way way;
        Outcome outcome;
    };

    [[nodiscard]] Way way_of(const Outcome& outcome) const;
    [[nodiscard]] std::optional<std::string> bystander_of(const Outcome& outcome) const;
    [[nodiscard]] std::vector<Way> ways() const;
    [[nodiscard]] bool is_excused(const Way& way, std::int64_t epoch, std::int64_t sequence) const;
    void excuse(const std::string& drone);
    void excuse_each(const std::vector<std::string>& drones);
    void excuse_plain(const Stage& stage);
    void excuse_receivers_of(const std::string& drone);
    void began_anew(const std::string& drone);
    void note_dead(Time now, Time until);
    void excuse_stage_of(const std::string& drone);
    /// Is it an exception that may come beside a result, see the first lines of model.cpp?
    [[nodiscard]] bool may_come_beside(const Outcome& outcome) const;
    [[nodiscard]] bool died_in_next_stage(const std::string& drone) const;
    /// Nobody works for the sender any more what this receiver has not answered, or `another` does.
    void left(const std::string& sender, const std::string& receiver, bool another);
    [[nodiscard]] bool has_another(const std::string& sender, const std::string& receiver, bool running) const;

    Topology topology_;
    Condition condition_;
    std::int64_t collectors_;
    std::vector<Excuse> excuses_;
    bool began_anew_ = false;          ///< some drone did
    std::set<std::string> cut_short_;  ///< drones that may have given up events and not acknowledged them
    std::set<std::string> died_;       ///< drones whose process was killed or replaced
    std::map<std::string, Time> dead_since_;
    std::chrono::milliseconds parted_{0};  ///< the machines, since everything was connected
    std::set<std::string> stopped_;        ///< drones that have forgotten what they were told, and for whom they worked
    std::set<std::pair<std::string, std::string>> alone_;  ///< sender, receiver: connected alone, whatever its stage is
    std::map<std::pair<std::int64_t, std::int64_t>, std::vector<Came>> came_;
    std::set<std::pair<std::string, std::pair<std::int64_t, std::int64_t>>> given_up_;    ///< by bystanders
    std::map<std::pair<Way, std::int64_t>, std::pair<std::int64_t, std::int64_t>> last_;  ///< of each way and epoch
};

}  // namespace hive::mixtures
