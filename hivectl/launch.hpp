// Starting a drone in the background, for the verbs that do.
#pragma once

#include <string>
#include <vector>

namespace hivectl {

class Session;

struct Launch {
    std::string kind, name, on_exception = {}, listen = {}, log_level = {};
    std::vector<std::string> settings = {};  ///< key=value
    bool insecure = false;
};

/// Runs the program of the kind; returns when it answers, having printed its name. Otherwise says why and returns the exit code.
int start_drone(const Launch& launch, Session& session);

}  // namespace hivectl
