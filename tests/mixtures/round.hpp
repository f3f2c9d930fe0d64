// One round: a plan is played and checked after its steps.
#pragma once

#include "checks.hpp"
#include "fates.hpp"
#include "ground.hpp"
#include "idle.hpp"
#include "lease.hpp"
#include "limits.hpp"
#include "pace.hpp"
#include "waits.hpp"
#include "watch.hpp"
#include "window.hpp"

#include <set>

namespace hive::mixtures {

/// How a round ended.
struct Played {
    std::size_t steps = 0;   ///< that were done
    Problems problems = {};  ///< of the last of them; empty: all is well
    std::string picture;     ///< what the drones said of themselves then
};

/// For how long has a picture been the same?
class Stillness {
public:
    explicit Stillness(const Ground& ground) : ground_(ground) {}

    /// Counts no more than 100 ms since the last look: who is held up has not seen that nothing moved.
    void look(std::string picture);
    [[nodiscard]] bool still() const { return looked_ - since_ >= ground_.stillness(); }

private:
    const Ground& ground_;
    std::string picture_;  ///< empty: unknown, so it has changed
    Ground::Clock::time_point since_ = ground_.now(), looked_ = since_;
};

class Round {
public:
    /// Connects the drones.
    Round(Plan plan, Ground& ground);
    /// Up to the first step with a problem.
    Played play();
    /// One step that need not be of the plan.
    /// @param last  a check afterwards waits until everything is there and connected
    Problems one(const Step& step, bool last);
    /// The events that are missing of an earlier run of the source, which produced that many.
    [[nodiscard]] Problems missing_of(std::int64_t epoch, std::int64_t produced) const
    {
        return model_.missing(epoch, produced);
    }

private:
    void perform(const Step& step);
    void set(const Step& step);
    void set_twice(const Step& step);
    void set_and_kill(const Step& step);
    void set_and_replace(const Step& step);
    void connect_all(const Step& step);
    Problems connect_all(std::chrono::milliseconds timeout = Application::Options().timeout);
    [[nodiscard]] Change change(int work_ms, int most_ms) const;
    [[nodiscard]] LastRun last_run() const;
    Problems wrongly_printed(const LastRun& run);
    Statuses look();
    void wait(std::chrono::milliseconds time, const std::string& busy = "");
    Problems watch(const Statuses& statuses);
    Problems settle(bool last);
    Problems stuck(const Statuses& statuses, Stillness& stillness) const;
    [[nodiscard]] bool all_up(const Statuses& statuses) const;
    [[nodiscard]] bool told_end(const Statuses& statuses) const;
    Problems at_rest(const Statuses& statuses, bool complete);
    [[nodiscard]] bool source_done(const Statuses& statuses) const;
    [[nodiscard]] bool whole(const Statuses& statuses, const std::string& drone) const;
    void end_excuses(const Statuses& statuses);
    Problems missing(const Statuses& statuses) const;
    void listen();

    Plan plan_;
    Model model_;
    Values values_;
    Ground& ground_;
    Watch watch_;
    Window window_;
    Pace pace_;
    Sizes sizes_;
    Waits waits_;
    Lease lease_;
    Overdue overdue_;
    Idle idle_;
    Fates fates_;
    std::set<std::string> stopped_;
    Problems problems_;  ///< found while steps were done
};

}  // namespace hive::mixtures
