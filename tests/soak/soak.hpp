// A swarm on three machines under faults drawn from a seed, until a promise is broken or the time is over.
#pragma once

#include "audited.hpp"
#include "growth.hpp"
#include "machines.hpp"

#include <round.hpp>

#include <deque>
#include <functional>
#include <iosfwd>

namespace hive::soak {

struct Options {
    std::uint64_t seed = 1;
    std::chrono::seconds time{600};
    std::chrono::duration<double> fault_every{10};
    bool plant_loss = false;  ///< a worker swallows results, which must be found
    std::function<bool()> interrupted = [] { return false; };
};

class Soak {
public:
    Soak(Options options, std::ostream& out);

    /// @return the exit code: 1 if a promise was broken
    int run();

private:
    using Clock = mixtures::Ground::Clock;

    struct Broken {};  ///< thrown at the first broken promise, which is in problems_
    struct Interrupted {};

    void go_on();
    void one_fault();
    /// Lets the source make more events if it may make fewer than these.
    void feed(const mixtures::Statuses& statuses, int ahead);
    void plant();
    void play(const mixtures::Step& step, bool last = false);
    /// @param ahead  events that the source may always make meanwhile
    void pause_until(Clock::time_point end, int ahead);
    void look(int ahead);
    void settle();
    void audit(bool at_rest);
    void require_cause();
    void require(mixtures::Problems problems);
    void stop();
    void line();
    void report();
    [[nodiscard]] std::int64_t came() const;
    [[nodiscard]] std::string age_text() const;

    Options options_;
    std::ostream& out_;
    mixtures::Random random_;
    Swarm swarm_;
    const Clock::time_point begun_ = Clock::now();
    Machines ground_;
    mixtures::Round round_;
    Growth growth_;
    mixtures::Problems problems_;
    std::deque<std::string> last_faults_;
    std::string audited_ = "none yet";
    Usages usages_;
    std::optional<std::int64_t> replaced_;  ///< epoch of a source that was replaced since the last rest
    Clock::time_point next_fault_ = begun_, next_line_ = begun_ + std::chrono::minutes(1), progressed_ = begun_;
    std::int64_t came_before_ = 0, oldest_us_ = 0;
    int faults_ = 0, audits_ = 0, rests_ = 0, causes_ = 0;
};

}  // namespace hive::soak
