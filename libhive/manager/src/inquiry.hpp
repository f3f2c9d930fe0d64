// Queries the statuses of drones without blocking, and waits for the first event of several.
#pragma once

#include "application_core.hpp"

#include <chrono>
#include <map>
#include <string>
#include <vector>

namespace hive {

/// For the thread of its application.
class Inquiry {
public:
    using Clock = event::Clock;

    /// @param pause  before a drone that has answered is queried again
    explicit Inquiry(Application& application, std::chrono::milliseconds pause = std::chrono::milliseconds(10))
        : core_(*application.core_), pause_(pause)
    {
    }

    /// Queries the drones without a pending query. Each answer arrives within `limit`, at least as an error.
    void ask(const std::vector<std::string>& drones, std::chrono::milliseconds limit);
    /// The answers since the last call, each with the first page of its rows.
    std::vector<StatusAnswer> take();
    /// Waits until an answer has arrived, a descriptor is readable or -1 (of a process that has exited), or that time.
    void wait(Clock::time_point until, const std::vector<int>& descriptors);

private:
    struct Asked {
        Place place{};
        Application::Core::Reply reply{};  ///< null: no pending query
        Clock::time_point next{};          ///< time of the next query
    };

    Application::Core& core_;
    std::chrono::milliseconds pause_;
    std::map<std::string, Asked> asked_;
};

}  // namespace hive
