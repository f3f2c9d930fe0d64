// Announces a drone on the local network as long as it lives.
#pragma once

#include <hive/discovery/announcement.hpp>
#include <hive/log_level.hpp>

#include <filesystem>
#include <memory>

namespace hive::discovery {

class DaemonThread;

/// Its thread only checks the key file once per second. Without Avahi it does nothing; it announces once the daemon is
/// up, and again when the daemon is restarted.
class Announcer {
public:
    struct Plan {
        std::string drone, kind;
        std::int64_t epoch = 0;
        Spot spot;
        std::filesystem::path key;  ///< the file
        Log log;                    ///< any thread, until the end of the Announcer
    };

    explicit Announcer(Plan plan);
    /// Withdraws the announcement.
    ~Announcer();
    Announcer(const Announcer&) = delete;
    Announcer& operator=(const Announcer&) = delete;

private:
    class Work;
    std::shared_ptr<Work> work_;
    std::unique_ptr<DaemonThread> thread_;
};

}  // namespace hive::discovery
