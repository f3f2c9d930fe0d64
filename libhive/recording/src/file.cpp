// Wraps the system calls.
#include <hive/recording/file.hpp>
#include <hive/recording/format.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <linux/openat2.h>
#include <stdexcept>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <system_error>
#include <unistd.h>

namespace hive::recording {
namespace {

[[noreturn]] void fail(const std::string& what) { throw std::system_error(errno, std::generic_category(), what); }

namespace fs = std::filesystem;

constexpr int owner_alone = 0600;  // images are private to the user

/// The error text if the file cannot be created.
[[noreturn]] void refuse(int error, const fs::path& folder, const fs::path& path)
{
    const auto whole = (folder / path).string();
    switch (error) {
    case EXDEV: throw std::runtime_error(whole + " does not lie below " + folder.string());
    case ELOOP: throw std::runtime_error(whole + " is a symbolic link, or behind one");
    case ENOENT:
    case ENOTDIR: throw std::runtime_error("there is no folder " + (folder / path).parent_path().string());
    case EISDIR: throw std::runtime_error(whole + " is not a file");
    case EEXIST:
        throw std::runtime_error(whole
                                 + " already exists; choose another name, or overwrite it (overwrite=on, --overwrite)");
    default: errno = error; fail("cannot make " + whole);
    }
}

int open_below(const fs::path& folder, const fs::path& path, bool overwrite)
{
    const platform::Descriptor place(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (!place)
        refuse(errno, folder, path);
    open_how how{};
    how.flags = O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOCTTY | (overwrite ? 0U : static_cast<unsigned>(O_EXCL));
    how.mode = owner_alone;
    how.resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS;
    const auto descriptor = static_cast<int>(::syscall(SYS_openat2, place.get(), path.c_str(), &how, sizeof how));
    if (descriptor < 0)
        refuse(errno, folder, path);
    return descriptor;
}

/// Advances the parts by the bytes written; there are only a few parts.
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

File File::create(const std::filesystem::path& folder, const std::filesystem::path& path, bool overwrite)
{
    File file(open_below(folder, path, overwrite));
    struct stat info {};
    if (::fstat(file.descriptor_.get(), &info) != 0 || !S_ISREG(info.st_mode))
        throw std::runtime_error((folder / path).string() + " is not a file");
    if (::flock(file.descriptor_.get(), LOCK_EX | LOCK_NB) != 0)
        throw std::runtime_error("another process is recording into " + (folder / path).string());
    if (!file.is_empty_or_recording())
        throw std::runtime_error((folder / path).string() + " is not a recording, and is not overwritten");
    file.truncate(0);
    return file;
}

bool File::is_empty_or_recording() const
{
    std::array<std::byte, file_magic.size()> magic{};
    return size() == 0 || (read(0, magic) && std::ranges::equal(magic, std::as_bytes(std::span(file_magic))));
}

std::uint64_t File::size() const
{
    struct stat info {};
    if (::fstat(descriptor_.get(), &info) != 0)
        fail("cannot look at the file");
    return static_cast<std::uint64_t>(info.st_size);
}

bool File::read(std::uint64_t offset, std::span<std::byte> to) const
{
    while (!to.empty()) {
        const auto count = ::pread(descriptor_.get(), to.data(), to.size(), static_cast<off_t>(offset));
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
            ::pwritev(descriptor_.get(), rest.data(), static_cast<int>(rest.size()), static_cast<off_t>(offset));
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
    while (
        ::fallocate(descriptor_.get(), FALLOC_FL_KEEP_SIZE, static_cast<off_t>(from), static_cast<off_t>(upto - from))
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
    if (::ftruncate(descriptor_.get(), static_cast<off_t>(size)) != 0)
        fail("cannot shorten the file");
}

int File::sync() const noexcept { return ::fdatasync(descriptor_.get()) == 0 ? 0 : errno; }

}  // namespace hive::recording
