// How a verb goes along with work on a whole swarm: progress on a terminal, Ctrl-C, and what came of it.
#pragma once

#include "interrupt.hpp"
#include "status_line.hpp"

#include <hive/swarm.hpp>

#include <string>
#include <string_view>

namespace hivectl {

/// The first Ctrl-C undoes what was begun. On a terminal, the status line says how far it is and for which drones it
/// waits.
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

/// Says on stderr what failed and what remains of it. Returns the exit code.
int complain_about(std::string_view verb, const hive::SwarmOutcome& outcome);

}  // namespace hivectl
