// Checks drones that were ready on another machine and do not answer here: they may have exited, or be unreachable.
#pragma once

#include "engine.hpp"
#include "ssh_session.hpp"

#include <hive/remote.hpp>

#include <list>
#include <map>
#include <string>
#include <vector>

namespace hive {

class SilentDrones {
public:
    using Clock = Engine::Clock;

    explicit SilentDrones(const Remote& remote) : remote_(remote) {}

    /// Starts a check, unless one runs or has just ended.
    void check(const std::string& drone, const Error& why);
    /// Adds the reports of the checks that have ended.
    void poll(std::vector<Engine::Report>& reports);
    void add_descriptors(std::vector<int>& all) const;

private:
    struct Silent {
        Error why;
        int found_running = 0;  ///< number of checks
        Clock::time_point next_check{};
    };

    void on_running(const std::string& drone, std::vector<Engine::Report>& reports);
    void read_log(const std::string& drone, std::vector<Engine::Report>& reports);

    const Remote& remote_;
    std::list<SshSession> checks_, logs_;
    std::map<std::string, Silent> silent_;
};

}  // namespace hive
