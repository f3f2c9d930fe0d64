#include <hive/transport/folder_lock.hpp>

#include <hive/error.hpp>
#include <hive/platform/files.hpp>

#include <cerrno>
#include <fcntl.h>

namespace hive::transport {

FolderLock::FolderLock(const std::filesystem::path& folder, std::chrono::milliseconds timeout)
    : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC))
{
    const auto problem =
        folder_ ? platform::lock(folder_.get(), timeout) : std::error_code(errno, std::generic_category());
    if (problem == std::errc::timed_out)
        throw Error(Errc::timeout, "another process has locked " + folder.string() + " for "
                                       + std::to_string(timeout.count()) + " ms");
    if (problem)
        throw Error(problem == std::errc::permission_denied ? Errc::not_permitted : Errc::io,
                    "cannot lock " + folder.string() + ": " + problem.message());
}

}  // namespace hive::transport
