// Processes of the system, from /proc.
#include <hive/platform/process.hpp>

#include <csignal>
#include <fstream>
#include <random>
#include <sstream>
#include <sys/resource.h>
#include <unistd.h>

namespace hive::platform {

std::int64_t own_pid() noexcept { return ::getpid(); }

namespace {

/// The fields of /proc/PID/stat after the process's name; empty: the process is gone.
std::istringstream process_fields(std::int64_t pid)
{
    std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
    std::string text;
    std::getline(file, text);  // an iterator would throw when the process is reaped between opening and reading
    const auto after_name = text.rfind(')');
    return std::istringstream(after_name == std::string::npos ? "" : text.substr(after_name + 1));
}

}  // namespace

bool process_ends(std::int64_t pid)
{
    constexpr unsigned exiting = 4;  // PF_EXITING of the kernel
    auto fields = process_fields(pid);
    std::string state, skipped;
    unsigned long flags = 0;
    fields >> state >> skipped >> skipped >> skipped >> skipped >> skipped >> flags;
    return state.empty() || state == "Z" || state == "X" || (flags & exiting) != 0;
}

bool process_is_suspended(std::int64_t pid)
{
    auto fields = process_fields(pid);
    std::string state;
    fields >> state;
    return state == "T";
}

void kill_process(std::int64_t pid) { ::kill(static_cast<pid_t>(pid), SIGKILL); }

std::size_t most_descriptors()
{
    rlimit limit{};
    return ::getrlimit(RLIMIT_NOFILE, &limit) == 0 ? limit.rlim_cur : 1024;
}

std::uint64_t entropy()
{
    std::random_device device;
    return std::uint64_t{device()} << 32 | device();
}

}  // namespace hive::platform
