// The files are named DRONE,NUMBER,RUN,EDGE.
#include <hive/error.hpp>
#include <hive/event/clock.hpp>
#include <hive/event/failure_file.hpp>
#include <hive/event/failure_store.hpp>
#include <hive/name.hpp>
#include <hive/platform/process.hpp>
#include <hive/transport/descriptor.hpp>
#include <hive/transport/folder_lock.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hive::event {
namespace fs = std::filesystem;

struct FailureStore::File {
    fs::path path;
    std::string drone;
    std::int64_t number = 0, run = 0;
    std::string edge;
    std::uintmax_t bytes = 0;
    fs::file_time_type time;
};

namespace {

constexpr std::string_view unfinished = ".new-";

[[noreturn]] void fail(const std::string& what) { throw Error(Errc::io, what + ": " + std::strerror(errno)); }

std::vector<std::string> fields_of_name(const std::string& name)
{
    std::vector<std::string> parts{""};
    for (const char c : name)
        c == ',' && parts.size() < 4 ? void(parts.emplace_back()) : parts.back().push_back(c);
    return parts;
}

std::int64_t number_of(const std::string& digits)
{
    std::int64_t number = -1;
    const auto end = digits.data() + digits.size();
    return std::from_chars(digits.data(), end, number).ptr == end ? number : -1;
}

/// Created with its mode, so that other users can never open it, and with its final size at most, so that other writers
/// make room for it.
void reserve(const fs::path& file, std::uintmax_t bytes)
{
    const transport::Descriptor made(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
    if (!made || ::ftruncate(made.get(), static_cast<off_t>(bytes)) != 0)
        fail("cannot write " + file.string());
}

void write(const fs::path& file, const KeptFailure& failure)
{
    std::ofstream out(file, std::ios::binary | std::ios::in);  // `in` keeps the reserved size
    write_failure(out, failure);
    const auto size = out.tellp();
    out.close();
    if (!out || ::truncate(file.c_str(), size) != 0)
        fail("cannot write " + file.string());
}

/// A file that is being written, or was when its process crashed.
class Unfinished {
public:
    explicit Unfinished(const fs::path& directory)
        : path_(directory
                / (std::string(unfinished) + std::to_string(platform::own_pid()) + "-"
                   + std::to_string(platform::entropy())))
    {
    }
    ~Unfinished()
    {
        std::error_code ignored;
        fs::remove(path_, ignored);  // no longer there once it was renamed
    }
    Unfinished(const Unfinished&) = delete;
    Unfinished& operator=(const Unfinished&) = delete;
    [[nodiscard]] const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

}  // namespace

FailureStore::FailureStore(const Home& home) : directory_(home.directory() / folder) {}

std::vector<FailureStore::File> FailureStore::files() const
{
    std::vector<File> found;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(directory_, ignored)) {
        const auto parts = fields_of_name(entry.path().filename().string());
        if (parts.size() != 4 || !is_name(parts[0]) || number_of(parts[1]) < 1 || number_of(parts[2]) < 0
            || !entry.is_regular_file(ignored))
            continue;
        found.push_back({.path = entry.path(),
                         .drone = parts[0],
                         .number = number_of(parts[1]),
                         .run = number_of(parts[2]),
                         .edge = parts[3],
                         .bytes = entry.file_size(ignored),
                         .time = entry.last_write_time(ignored)});
    }
    std::ranges::sort(found, [](const File& one, const File& other) {
        return one.number != other.number ? one.number < other.number : one.edge < other.edge;
    });
    return found;
}

/// The number of a failure among these files: that of the same crash, or the next one.
std::int64_t FailureStore::number_for(const KeptFailure& failure, const std::vector<File>& files)
{
    std::int64_t next = 1;
    for (const auto& file : files) {
        if (file.drone != failure.drone)
            continue;
        if (failure.run != 0 && file.run == failure.run)
            return file.number;
        next = std::max(next, file.number + 1);
    }
    return next;
}

std::int64_t FailureStore::keep(const KeptFailure& failure, const std::string& edge) const
{
    const auto bytes = failure_file_bound(failure);
    if (bytes > max_bytes)
        return 0;
    if (::mkdir(directory_.c_str(), 0700) != 0 && errno != EEXIST)
        fail("cannot make " + directory_.string());
    const Unfinished fresh(directory_);
    {
        const transport::FolderLock lock(directory_, max_wait);
        make_room(failure, bytes);
        reserve(fresh.path(), bytes);
    }
    write(fresh.path(), failure);
    const transport::FolderLock lock(directory_, max_wait);  // not while bodies are written
    const auto number = number_for(failure, files());
    constexpr std::size_t max_edge = 128;  // so that the file name is valid on all file systems
    const auto name = failure.drone + "," + std::to_string(number) + "," + std::to_string(failure.run) + ","
                      + edge.substr(0, max_edge);
    std::error_code problem;
    fs::rename(fresh.path(), directory_ / name, problem);
    if (problem)
        throw Error(Errc::io, "cannot keep " + (directory_ / name).string());
    return number;
}

/// Bytes of the files that are being written. Removes those of crashed writers.
std::uintmax_t FailureStore::unfinished_bytes() const
{
    std::uintmax_t bytes = 0;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(directory_, ignored)) {
        const auto name = entry.path().filename().string();
        if (!name.starts_with(unfinished))
            continue;
        const auto pid = number_of(name.substr(unfinished.size(), name.rfind('-') - unfinished.size()));
        // Its pid may be that of another process by now, but no writer pauses that long.
        constexpr int longest_pause_s = 60;
        struct stat about {};
        const bool stale =
            ::stat(entry.path().c_str(), &about) == 0 && about.st_mtime < wall_us() / 1'000'000 - longest_pause_s;
        if (stale || platform::process_ends(pid))
            fs::remove(entry.path(), ignored);
        else if (const auto size = entry.file_size(ignored); !ignored)
            bytes += size;
    }
    return bytes;
}

/// Removes the oldest failures of its drone if that has too many, then the oldest of all.
void FailureStore::make_room(const KeptFailure& failure, std::uintmax_t bytes) const
{
    bytes += unfinished_bytes();
    if (bytes > max_bytes)
        throw Error(Errc::refused, "other failures are being written, and together they are too large");
    std::error_code ignored;
    auto all = files();
    std::set<std::int64_t> numbers{number_for(failure, all)};
    for (const auto& file : all)
        if (file.drone == failure.drone)
            numbers.insert(file.number);
    while (numbers.size() > max_failures)
        numbers.erase(numbers.begin());
    std::erase_if(all, [&](const File& file) {
        return file.drone == failure.drone && !numbers.contains(file.number) && fs::remove(file.path, ignored);
    });
    std::ranges::sort(all, std::greater(), &File::time);
    std::size_t count = 1;
    for (const auto& file : all)
        if ((bytes += file.bytes) > max_bytes || ++count > max_files)
            fs::remove(file.path, ignored);
}

std::vector<std::string> FailureStore::drones() const
{
    std::set<std::string> names;
    for (const auto& file : files())
        names.insert(file.drone);
    return {names.begin(), names.end()};
}

std::vector<KeptFailure> FailureStore::read(const std::string& drone, bool bodies) const
{
    std::vector<KeptFailure> failures;
    for (const auto& file : files()) {
        if (file.drone != drone)
            continue;
        KeptFailure part;
        try {
            part = read_failure(file.path, bodies);
        } catch (const Error&) {
            continue;  // removed meanwhile, or changed by hand
        }
        part.drone = drone;
        part.number = file.number;
        part.run = file.run;
        if (failures.empty() || failures.back().number != part.number) {
            failures.push_back(std::move(part));
            continue;
        }
        std::ranges::move(part.inputs, std::back_inserter(failures.back().inputs));
    }
    return failures;
}

}  // namespace hive::event
