// How a verb goes along with work on a whole swarm: progress on a terminal, Ctrl-C, and what came of it.
#pragma once

#include "interrupt.hpp"

#include <hive/swarm.hpp>

#include <string>
#include <string_view>

namespace hivectl {

/// The first Ctrl-C undoes what was begun. On a terminal, stderr has a line of progress, which goes with this. What
/// is waited for is said there, too.
class SwarmWork {
public:
    explicit SwarmWork(const std::string& verb);
    ~SwarmWork();
    SwarmWork(const SwarmWork&) = delete;
    SwarmWork& operator=(const SwarmWork&) = delete;

    [[nodiscard]] const hive::SwarmWatch& watch() const { return watch_; }

private:
    void clear();

    interrupt::Deferred deferred_;
    hive::SwarmWatch watch_;
    bool shown_ = false;
};

/// Says on stderr what failed and what remains of it. Returns the exit code.
int complain_about(std::string_view verb, const hive::SwarmOutcome& outcome);

}  // namespace hivectl
