// Excludes other processes while one changes files of a folder.
#pragma once

#include <hive/transport/descriptor.hpp>

#include <chrono>
#include <filesystem>

namespace hive::transport {

/// Holds the lock of a folder as long as it lives. The kernel releases it however the process ends. Changes take
/// milliseconds, so a process that holds it longer is stopped or faulty.
class FolderLock {
public:
    /// Throws Errc::timeout if other processes have held it for that long, not_permitted, io.
    explicit FolderLock(const std::filesystem::path& folder,
                        std::chrono::milliseconds timeout = std::chrono::seconds(2));

private:
    Descriptor folder_;
};

}  // namespace hive::transport
