// Progress, cancellation and result of a verb's work on a whole swarm.
#pragma once

#include "run/interrupt.hpp"
#include "words/status_line.hpp"

#include <hive/swarm.hpp>

#include <string>
#include <string_view>

namespace hivectl {

/// The first Ctrl-C rolls back. On a terminal, the status line shows the progress and the drones that it waits for.
class SwarmWork {
public:
    explicit SwarmWork(const std::string& verb);

    [[nodiscard]] const hive::SwarmWatch& watch() const { return watch_; }

private:
    void show();

    interrupt::Deferred deferred_;
    hive::SwarmWatch watch_;
    std::string progress_, drones_ = "the swarm";
    Waiting waiting_{drones_};
};

/// Prints failures and remains on stderr. Returns the exit code.
int complain_about(std::string_view verb, const hive::SwarmOutcome& outcome);

}  // namespace hivectl
