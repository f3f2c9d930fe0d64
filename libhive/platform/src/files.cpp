// The file system's own writes and locks.
#include <hive/platform/crash_signals.hpp>
#include <hive/platform/files.hpp>

#include <atomic>
#include <cerrno>
#include <fcntl.h>
#include <fstream>
#include <future>
#include <sys/file.h>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace hive::platform {
namespace {

int lock_without_deadline(int descriptor)
{
    while (::flock(descriptor, LOCK_EX) != 0)
        if (errno != EINTR)
            return errno;
    return 0;
}

}  // namespace

bool write_private(const std::filesystem::path& file, const std::string& text)
{
    std::ofstream stream(file, std::ios::trunc);
    std::error_code ignored;  // the folder is for its owner only, too
    std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write,
                                 ignored);
    stream << text;
    return !stream.flush().fail();
}

std::error_code rename(const std::filesystem::path& from, const std::filesystem::path& to)
{
    std::error_code problem;
    std::filesystem::rename(from, to, problem);
    return problem;
}

/// flock(2) has no deadline, so a thread blocks in it. It has its own descriptor of the open file: a lock that it gets
/// too late is released at once.
std::error_code lock(int descriptor, std::chrono::nanoseconds timeout)
{
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0)
        return {};
    if (errno != EWOULDBLOCK)
        return {errno, std::generic_category()};
    constexpr int max_waiting = 8;
    static std::atomic<int> waiting = 0;
    if (waiting >= max_waiting)  // a process holds such a lock for long: it is suspended
        return std::make_error_code(std::errc::timed_out);
    const int copy = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
    if (copy < 0)
        return {errno, std::generic_category()};
    std::promise<int> locked;
    auto error = locked.get_future();
    try {
        const SignalsBlocked blocked;
        std::thread([copy, locked = std::move(locked)]() mutable {
            const int result = lock_without_deadline(copy);
            ::close(copy);
            --waiting;
            locked.set_value(result);
        }).detach();
        ++waiting;
    } catch (const std::system_error& none_left) {
        ::close(copy);
        return none_left.code();
    }
    if (error.wait_for(timeout) == std::future_status::ready)
        return {error.get(), std::generic_category()};
    return std::make_error_code(std::errc::timed_out);
}

}  // namespace hive::platform
