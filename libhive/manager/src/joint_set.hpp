// One set for many drones: prepared on all of them, then committed on all or on none.
#pragma once

#include <hive/application.hpp>
#include <hive/event/module.hpp>
#include <hive/platform/process.hpp>

#include <variant>

#include <random>

namespace hive {

/// For one thread, once. A drone that somebody else is setting is asked again until the deadline.
class JointSet {
public:
    struct Terms {
        /// What they are called, and where each is met, or why nobody knows that.
        std::vector<std::pair<std::string, std::variant<Place, Error>>> drones;
        Json parameters;
        event::Clock::time_point deadline;  ///< nothing is committed later
        std::function<bool()> cancelled;    ///< asked all the time; once true, nothing more is decided to be committed
    };
    JointSet(event::Module& module, Terms terms);

    SetResult run();

private:
    /// One drone in one attempt. The network side writes the outcomes.
    struct Part {
        explicit Part(std::string name) : drone(std::move(name)) {}
        void let_go();

        std::string drone;
        event::LinkPtr link;  ///< which was asked to prepare; the decision is for no other
        std::optional<event::Outcome> prepared, decided;
        bool over = false;  ///< decided: what comes of the prepare now is of no interest
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
    /// Until the condition, which is asked with the turn.
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

/// The deadline that a drone is given, so that it answers before its asker gives up at `deadline`.
std::int64_t deadline_ms_before(event::Clock::time_point deadline);

}  // namespace hive
