// Sets parameters of many drones: prepares on all, then commits on all or on none.
#pragma once

#include <hive/application.hpp>
#include <hive/event/module.hpp>
#include <hive/platform/process.hpp>
#include <hive/result.hpp>

#include <random>

namespace hive {

/// For one thread, once. If another application is setting a drone, the set is retried until the deadline.
class JointSet {
public:
    struct Terms {
        /// Names and places of the drones, or why a place is unknown.
        std::vector<std::pair<std::string, Result<Place>>> drones;
        Json parameters;
        event::Clock::time_point deadline;  ///< nothing is committed later
        std::function<bool()> cancelled;    ///< polled; once true, nothing is committed any more
    };
    JointSet(event::Module& module, Terms terms);

    SetResult run();

private:
    /// One drone in one attempt. The network side writes the outcomes.
    struct Part {
        explicit Part(std::string name) : drone(std::move(name)) {}
        void let_go();

        std::string drone;
        event::LinkPtr link;  ///< the link of the prepare; the decision goes to no other
        std::optional<event::Outcome> prepared, decided;
        bool over = false;  ///< decided: the outcome of the prepare is ignored now
    };
    using PartPtr = std::shared_ptr<Part>;
    using Condition = bool (JointSet::*)();

    void prepare();
    void prepare(const PartPtr& part, const Place& place);
    void ask_to_prepare(const PartPtr& part, const event::LinkPtr& link);
    bool commit();
    void abort();
    [[nodiscard]] static bool may_hold(const Part& part);
    void tell(const PartPtr& part, const char* decision, event::Clock::time_point until);
    void pause();
    /// Waits until the condition, called with the turn.
    void wait(event::Clock::time_point until, Condition done, const std::function<bool()>& cancelled);

    // --- with the turn ---
    [[nodiscard]] bool none() { return false; }
    [[nodiscard]] bool prepared_or_refused();
    [[nodiscard]] bool all_prepared();
    [[nodiscard]] bool all_decided();
    [[nodiscard]] bool lost_one();

    [[nodiscard]] bool only_locked() const;
    [[nodiscard]] SetResult unchanged() const;
    [[nodiscard]] SetResult committed() const;

    event::Module& module_;
    Terms terms_;
    std::mt19937_64 random_{platform::entropy()};
    std::int64_t token_ = 0;
    int attempts_ = 0;
    std::vector<PartPtr> parts_;
};

/// The deadline for a drone, so that it answers before its caller gives up at `deadline`.
std::int64_t deadline_ms_before(event::Clock::time_point deadline);

}  // namespace hive
