// Asks drones how they are without waiting for any of them, and waits for whatever comes first.
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

    /// @param pause  before a drone that has answered is asked again
    explicit Inquiry(Application& application, std::chrono::milliseconds pause = std::chrono::milliseconds(10))
        : core_(*application.core_), pause_(pause)
    {
    }

    /// Asks those of which no answer is due. Each answer is there within `limit`, if only as an error.
    void ask(const std::vector<std::string>& drones, std::chrono::milliseconds limit);
    /// What has come since the last call, with the first page of the rows of each.
    std::vector<StatusAnswer> take();
    /// Until an answer can be taken, a descriptor is readable, or the time has come.
    void wait(Clock::time_point until, const std::vector<int>& descriptors);

private:
    struct Asked {
        Place place{};
        Application::Core::Reply reply{};  ///< null: not being asked
        Clock::time_point next{};          ///< not to be asked earlier
    };

    Application::Core& core_;
    std::chrono::milliseconds pause_;
    std::map<std::string, Asked> asked_;
};

}  // namespace hive
