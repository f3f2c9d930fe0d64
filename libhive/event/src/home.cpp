// Paths, locks and state files in the runtime directory.
#include <hive/error.hpp>
#include <hive/event/home.hpp>
#include <hive/name.hpp>
#include <hive/platform/files.hpp>
#include <hive/platform/process.hpp>
#include <hive/protocol/defended.hpp>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <set>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hive::event {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(Errc code, const std::string& what) { throw Error(code, what + ": " + std::strerror(errno)); }

void make_private(const fs::path& directory)
{
    std::error_code ignored;
    if (directory.has_parent_path())
        fs::create_directories(directory.parent_path(), ignored);
    if (::mkdir(directory.c_str(), 0700) != 0 && errno != EEXIST)
        fail(Errc::io, "cannot make " + directory.string());
    struct stat info {};
    if (::lstat(directory.c_str(), &info) != 0)
        fail(Errc::io, "cannot stat " + directory.string());
    if (!S_ISDIR(info.st_mode) || info.st_uid != ::getuid())
        throw Error(Errc::not_permitted, directory.string() + " is not a directory of this user",
                    "set HIVE_HOME to one that is");
    if ((info.st_mode & 077) != 0)
        throw Error(Errc::not_permitted, "others may enter " + directory.string(),
                    "fix it: chmod 700 " + directory.string());
}

/// Open-file-description locks: they end with the process, and can be checked without being taken.
struct flock whole_file(short type)
{
    struct flock lock {};
    lock.l_type = type;
    lock.l_whence = SEEK_SET;
    return lock;
}

constexpr std::string_view name_ending = ".lock", succession_ending = ".next", state_ending = ".state",
                           return_ending = ".returns", crash_ending = ".crash";

std::int64_t number_in(const fs::path& file)
{
    std::int64_t number = 0;
    std::ifstream(file) >> number;
    return number;
}

}  // namespace

fs::path default_home()
{
    const auto variable = [](const char* name) { return std::string(std::getenv(name) ? std::getenv(name) : ""); };
    if (const auto home = variable("HIVE_HOME"); !home.empty())
        return home;
    if (const auto runtime = variable("XDG_RUNTIME_DIR"); !runtime.empty())
        return fs::path(runtime) / "hive";
    return "/tmp/hive-" + std::to_string(::getuid());
}

Home::Home(fs::path directory) : directory_(fs::absolute(directory)) { make_private(directory_); }

fs::path Home::path(const std::string& name, std::string_view ending) const
{
    return directory_ / (require_name(name, "drone") + std::string(ending));
}

transport::Address Home::address(const std::string& name) const
{
    return {transport::Address::Scheme::unix_socket, path(name, ".sock").string(), 0};
}

std::vector<std::string> Home::names() const
{
    std::set<std::string> names;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(directory_, ignored)) {
        const auto name = entry.path().stem().string();
        if (!is_name(name))
            continue;
        const auto ending = entry.path().extension();
        // Between the sockets of two processes, a drone that is being replaced has only its state. If the second one
        // appeared since the directory was read, the succession may be over.
        const bool listed =
            ending == ".sock" || (ending == ".state" && (succession(name) || fs::exists(path(name, ".sock"), ignored)));
        if (listed)
            names.insert(name);
    }
    return {names.begin(), names.end()};
}

/// Checks the name twice: a replace may have ended between the first two checks.
bool Home::runs(const std::string& name) const { return alive(name) || succession(name) || alive(name); }

bool Home::alive(const std::string& name) const { return bool(lock_of(name)); }
transport::Descriptor Home::lock_of(const std::string& name) const { return lock_of(name, name_ending); }
bool Home::succession(const std::string& name) const { return bool(lock_of(name, succession_ending)); }
std::int64_t Home::holder(const std::string& name) const { return number_in(path(name, name_ending)); }
std::int64_t Home::successor(const std::string& name) const { return number_in(path(name, succession_ending)); }

transport::Descriptor Home::lock_of(const std::string& name, std::string_view ending) const
{
    transport::Descriptor file(::open(path(name, ending).c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW));
    return is_locked(file) ? std::move(file) : transport::Descriptor();
}

bool Home::is_locked(const transport::Descriptor& lock)
{
    struct flock whole = whole_file(F_WRLCK);
    return lock
           && (!defended("living-holder")
               || (::fcntl(lock.get(), F_OFD_GETLK, &whole) == 0 && whole.l_type != F_UNLCK));
}

namespace {

constexpr JsonLimits limits_of_state{.bytes = 1 << 20, .depth = 16, .keys = 1024, .string_bytes = 16 * 1024};

std::optional<Json> json_in(const fs::path& path, const JsonLimits& limits)
{
    std::ifstream file(path);
    if (!file)
        return std::nullopt;
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    return parse_json(text, limits);
}

/// Writes one file, and removes another.
void replace_by(const fs::path& file, const Json& content, const fs::path& old)
{
    replace_file(file, content.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
    std::error_code ignored;
    fs::remove(old, ignored);
}

}  // namespace

std::optional<Json> Home::read_state(const std::string& name) const
{
    return json_in(path(name, state_ending), limits_of_state);
}

std::optional<Json> Home::read_return(const std::string& name) const
{
    return json_in(path(name, return_ending), limits_of_state);
}

std::optional<Json> Home::read_crash(const std::string& name) const
{
    return json_in(path(name, crash_ending), {.bytes = 8 * 1024, .depth = 2, .keys = 8, .string_bytes = 2 * 1024});
}

void Home::write_state(const std::string& name, const Json& state) const
{
    replace_by(path(name, state_ending), state, path(name, return_ending));
}

void Home::write_return(const std::string& name, const Json& left) const
{
    replace_by(path(name, return_ending), left, path(name, state_ending));
}

bool Home::has_state(const std::string& name) const
{
    std::error_code ignored;
    return fs::exists(path(name, state_ending), ignored);
}

void Home::forget_state(const std::string& name) const noexcept
{
    std::error_code ignored;
    for (const auto ending : {state_ending, return_ending, crash_ending})
        fs::remove(path(name, ending), ignored);
}

void replace_file(const fs::path& file, const std::string& text)
{
    const fs::path fresh = file.string() + ".new";
    if (!platform::write_private(fresh, text))
        fail(Errc::io, "cannot write " + fresh.string());
    if (const auto problem = platform::rename(fresh, file))
        throw Error(Errc::io, "cannot replace " + file.string() + ": " + problem.message());
}

NameClaim::NameClaim(const Home& home, const std::string& name, To what)
{
    const auto file = home.path(name, what == To::name ? name_ending : succession_ending);
    lock_ = transport::Descriptor(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
    if (!lock_)
        fail(Errc::io, "cannot open " + file.string());
    struct flock whole = whole_file(F_WRLCK);
    const bool noted = !defended("living-holder") && number_in(file) != 0;
    if (noted || ::fcntl(lock_.get(), F_OFD_SETLK, &whole) != 0) {
        char holder[32] = {};
        const auto length = ::pread(lock_.get(), holder, sizeof holder - 1, 0);
        throw Error(Errc::name_taken, name + (what == To::name ? " runs already" : " is being replaced already")
                                          + (length > 0 ? ", as process " + std::string(holder) : ""));
    }
    const auto pid = std::to_string(platform::own_pid());
    if (::ftruncate(lock_.get(), 0) != 0 || ::pwrite(lock_.get(), pid.data(), pid.size(), 0) < 0)
        fail(Errc::io, "cannot write " + file.string());
    if (std::error_code ignored; what == To::name)
        fs::remove(home.path(name, crash_ending), ignored);
}

}  // namespace hive::event
