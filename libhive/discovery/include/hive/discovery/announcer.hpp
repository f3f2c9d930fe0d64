// Announces a drone on the local network as long as it lives.
#pragma once

#include <hive/discovery/announcement.hpp>
#include <hive/log_level.hpp>

#include <filesystem>
#include <memory>

namespace hive::discovery {

class DaemonThread;

/// Costs its thread nothing but one look a second at the key file. Without Avahi it does nothing; it begins when the
/// daemon comes, and again when the daemon comes back.
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
    /// Takes the announcement back.
    ~Announcer();
    Announcer(const Announcer&) = delete;
    Announcer& operator=(const Announcer&) = delete;

private:
    class Work;
    std::shared_ptr<Work> work_;
    std::unique_ptr<DaemonThread> thread_;
};

}  // namespace hive::discovery
