// One round: a plan is played on real drones and checked after its steps.
#pragma once

#include "checks.hpp"
#include "collecting.hpp"
#include "model.hpp"
#include "running.hpp"

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
    /// After that nothing moves. A source must say within 1 s why it does not.
    static constexpr auto time = std::chrono::milliseconds(test::sanitized() ? 3000 : 1100);

    /// Counts no more than 100 ms since the last look: who is held up has not seen that nothing moved.
    void look(std::string picture);
    [[nodiscard]] bool still() const { return looked_ - since_ >= time; }

private:
    std::string picture_;  ///< empty: unknown, so it has changed
    test::Clock::time_point since_ = test::Clock::now(), looked_ = since_;
};

class Round {
public:
    explicit Round(Plan plan);
    /// Up to the first step with a problem.
    Played play();

private:
    Problems one(const Step& step, bool last);
    void perform(const Step& step);
    void set(const Step& step);
    void set_twice(const Step& step);
    void set_and_kill(const Step& step);
    [[nodiscard]] Change change(int work_ms, int most_ms) const;
    Problems settle(bool last);
    Problems stuck(const Statuses& statuses, Stillness& stillness) const;
    Problems at_rest(const Statuses& statuses, bool complete);
    [[nodiscard]] bool source_done(const Statuses& statuses) const;
    [[nodiscard]] bool whole(const Statuses& statuses, const std::string& drone) const;
    void end_excuses(const Statuses& statuses);
    Problems missing(const Statuses& statuses) const;
    void listen();

    Plan plan_;
    Model model_;
    Values values_;
    Running running_;
    Collecting collecting_;
    std::set<std::string> stopped_;
    Problems problems_;  ///< found while steps were done
};

/// A round with its beginning and its end; also what is left of it is a problem.
Played play(const Plan& plan);

}  // namespace hive::mixtures
