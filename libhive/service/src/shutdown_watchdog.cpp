// Waits for a drone's code to return, for a limited time.
#include "shutdown_watchdog.hpp"

#include <condition_variable>
#include <mutex>
#include <unistd.h>

namespace hive::service {

void ShutdownWatchdog::begin(const std::filesystem::path& socket, std::chrono::seconds grace)
{
    thread_ = std::jthread([socket, grace](const std::stop_token& ended) {
        std::mutex mutex;
        std::unique_lock lock(mutex);
        std::condition_variable_any().wait_for(lock, ended, grace, [] { return false; });
        if (ended.stop_requested())
            return;
        std::error_code ignored;
        std::filesystem::remove(socket, ignored);
        ::_exit(0);
    });
}

}  // namespace hive::service
