// Writes lines, and rotates the file when it is full.
#include "bounded_log.hpp"

#include <hive/printable.hpp>
#include <hive/transport/descriptor.hpp>

#include <fcntl.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hive {
namespace {

/// Copies as much as fits on the disk: the log stays bounded even if its older half cannot be kept.
void keep(const std::filesystem::path& from, const std::filesystem::path& to)
{
    const transport::Descriptor in(::open(from.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
    const transport::Descriptor out(::open(to.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600));
    while (in && out && ::sendfile(out.get(), in.get(), nullptr, 1 << 20) > 0) {
    }
}

}  // namespace

void BoundedLog::sink_it_(const spdlog::details::log_msg& message)
{
    const std::string safe = printable(shortened({message.payload.data(), message.payload.size()}));
    spdlog::details::log_msg shown = message;
    shown.payload = safe;
    spdlog::memory_buf_t line;
    formatter_->format(shown, line);
    make_room(static_cast<long>(line.size()));
    for (std::size_t written = 0; written < line.size();) {
        const auto bytes = ::write(STDERR_FILENO, line.data() + written, line.size() - written);
        if (bytes <= 0)
            return;  // no way to report it
        written += static_cast<std::size_t>(bytes);
    }
}

void BoundedLog::make_room(long bytes) const
{
    struct stat written {};
    struct stat named {};
    if (::fstat(STDERR_FILENO, &written) != 0 || !S_ISREG(written.st_mode) || written.st_size + bytes <= most_bytes)
        return;
    const bool ours = ::lstat(file_.c_str(), &named) == 0 && named.st_dev == written.st_dev
                      && named.st_ino == written.st_ino && (::fcntl(STDERR_FILENO, F_GETFL) & O_APPEND) != 0;
    if (!ours)
        return;
    keep(file_, file_.string() + ".1");
    [[maybe_unused]] const int cut = ::ftruncate(STDERR_FILENO, 0);
}

}  // namespace hive
