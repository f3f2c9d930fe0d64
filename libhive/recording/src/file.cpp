// The system calls.
#include <hive/recording/file.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <stdexcept>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace hive::recording {
namespace {

[[noreturn]] void fail(const std::string& what) { throw std::system_error(errno, std::generic_category(), what); }

void check_path(const std::filesystem::path& path, bool overwrite)
{
    std::error_code problem;
    const auto parent = std::filesystem::absolute(path).parent_path();
    if (!std::filesystem::is_directory(parent, problem))
        throw std::runtime_error("there is no folder " + parent.string());
    const auto status = std::filesystem::status(path, problem);
    if (!std::filesystem::exists(status))
        return;
    if (!std::filesystem::is_regular_file(status))
        throw std::runtime_error(path.string() + " is not a file");
    if (!overwrite)
        throw std::runtime_error(
            path.string() + " is there already; choose another name, or overwrite it (overwrite=on, --overwrite)");
}

/// Moves the beginning of the parts on by what was written; at most a handful of parts.
void skip_written(std::span<iovec>& parts, std::size_t written)
{
    while (!parts.empty() && written >= parts.front().iov_len) {
        written -= parts.front().iov_len;
        parts = parts.subspan(1);
    }
    if (!parts.empty()) {
        parts.front().iov_base = static_cast<char*>(parts.front().iov_base) + written;
        parts.front().iov_len -= written;
    }
}

}  // namespace

File File::open_to_read(const std::filesystem::path& path)
{
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0)
        fail("cannot open " + path.string());
    File file(descriptor);
    struct stat info {};
    if (::fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode))
        throw std::runtime_error(path.string() + " is not a file");
    return file;
}

File File::create(const std::filesystem::path& path, bool overwrite)
{
    check_path(path, overwrite);
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | (overwrite ? 0 : O_EXCL), 0666);
    if (descriptor < 0)
        fail("cannot make " + path.string());
    File file(descriptor);
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0)
        throw std::runtime_error("another process is recording into " + path.string());
    file.truncate(0);
    return file;
}

File::~File()
{
    if (descriptor_ >= 0)
        ::close(descriptor_);
}

File::File(File&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

std::uint64_t File::size() const
{
    struct stat info {};
    if (::fstat(descriptor_, &info) != 0)
        fail("cannot look at the file");
    return static_cast<std::uint64_t>(info.st_size);
}

bool File::read(std::uint64_t offset, std::span<std::byte> to) const
{
    while (!to.empty()) {
        const auto count = ::pread(descriptor_, to.data(), to.size(), static_cast<off_t>(offset));
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0)
            fail("cannot read the file");
        if (count == 0)
            return false;
        to = to.subspan(static_cast<std::size_t>(count));
        offset += static_cast<std::uint64_t>(count);
    }
    return true;
}

void File::write(std::uint64_t offset, std::initializer_list<std::span<const std::byte>> parts)
{
    std::array<iovec, 8> vectors{};
    std::ranges::transform(parts, vectors.begin(), [](auto part) {
        return iovec{const_cast<std::byte*>(part.data()), part.size()};
    });
    std::span<iovec> rest(vectors.data(), parts.size());
    skip_written(rest, 0);
    while (!rest.empty()) {
        const auto count =
            ::pwritev(descriptor_, rest.data(), static_cast<int>(rest.size()), static_cast<off_t>(offset));
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0)
            fail("cannot write");
        offset += static_cast<std::uint64_t>(count);
        skip_written(rest, static_cast<std::size_t>(count));
    }
}

bool File::reserve(std::uint64_t from, std::uint64_t upto)
{
    while (::fallocate(descriptor_, FALLOC_FL_KEEP_SIZE, static_cast<off_t>(from), static_cast<off_t>(upto - from))
           != 0) {
        if (errno == EINTR)
            continue;
        if (errno == EOPNOTSUPP || errno == ENOSYS)
            return false;
        fail("cannot take space");
    }
    return true;
}

void File::truncate(std::uint64_t size)
{
    if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0)
        fail("cannot shorten the file");
}

int File::sync() const noexcept { return ::fdatasync(descriptor_) == 0 ? 0 : errno; }

}  // namespace hive::recording
