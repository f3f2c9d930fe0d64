// A swarm's home directory, and commands in it.
#include "swarm.hpp"

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <stdexcept>
#include <unistd.h>

namespace hive::test {
namespace fs = std::filesystem;
namespace {

fs::path fresh_home()
{
    std::string name = "/tmp/hv-XXXXXX";  // short: the path of a socket has at most 107 characters
    if (!::mkdtemp(name.data()))
        throw std::runtime_error("cannot make a directory in /tmp");
    return name;
}

/// The process that holds a drone's lock, by the kernel.
std::optional<pid_t> holder(const fs::path& lock)
{
    const int descriptor = ::open(lock.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor < 0)
        return std::nullopt;
    struct flock whole {};
    whole.l_type = F_WRLCK;
    const bool held = ::fcntl(descriptor, F_OFD_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
    ::close(descriptor);
    pid_t pid = 0;
    std::ifstream(lock) >> pid;
    return held && pid > 1 ? std::optional(pid) : std::nullopt;
}

std::vector<fs::path> locks(const fs::path& home)
{
    std::vector<fs::path> result;
    for (const auto& entry : fs::directory_iterator(home))
        if (entry.path().extension() == ".lock")
            result.push_back(entry.path());
    return result;
}

}  // namespace

Swarm::Swarm() : home_(fresh_home()), programs_(fs::read_symlink("/proc/self/exe").parent_path()) {}

Swarm::~Swarm()
{
    for (const auto& lock : locks(home_)) {
        if (const auto pid = holder(lock))
            ::kill(*pid, SIGKILL);
        eventually([&] { return !holder(lock); });
    }
    std::error_code ignored;
    fs::remove_all(home_, ignored);
}

fs::path Swarm::program(const std::string& name) const { return programs_ / name; }

std::vector<std::string> Swarm::environment() const
{
    const char* path = std::getenv("PATH");
    return {"HIVE_HOME=" + home_.string(), "PATH=" + programs_.string() + ":" + (path ? path : "/usr/bin:/bin"),
            "XDG_CONFIG_HOME=" + (home_ / "config").string(),
            "HIVE_KEY=", "DBUS_SYSTEM_BUS_ADDRESS=unix:path=" + (home_ / "bus").string()};
}

Finished Swarm::run(const std::vector<std::string>& words, Milliseconds timeout) const
{
    const fs::path stem = home_ / ("command-" + std::to_string(++commands_));
    const fs::path out = stem.string() + ".out", err = stem.string() + ".err";
    const auto begin = Clock::now();
    Process process(words, environment(), out, err);
    auto code = process.wait(patient(timeout));
    const auto took = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin);
    process.kill();
    Finished finished{code.value_or(128 + SIGKILL), text_of(out), text_of(err), took};
    fs::remove(out);
    fs::remove(err);
    return finished;
}

Finished Swarm::hivectl(const std::vector<std::string>& words, Milliseconds timeout) const
{
    std::vector<std::string> all{program("hivectl").string()};
    all.insert(all.end(), words.begin(), words.end());
    return run(all, timeout);
}

std::string Swarm::hivectl_done(const std::vector<std::string>& words, Milliseconds timeout) const
{
    auto finished = hivectl(words, timeout);
    std::string line = "hivectl";
    for (const auto& word : words)
        line += " " + word;
    if (finished.exit_code != 0)
        throw std::runtime_error(line + " exited with " + std::to_string(finished.exit_code) + "\n" + finished.out
                                 + finished.err);
    return std::move(finished.out);
}

Process Swarm::hivectl_running(const std::vector<std::string>& words, const std::string& name) const
{
    std::vector<std::string> all{program("hivectl").string()};
    all.insert(all.end(), words.begin(), words.end());
    return {all, environment(), home_ / (name + ".log")};
}

Process Swarm::drone(const std::string& kind, const std::string& name, const std::vector<std::string>& settings,
                     const std::vector<std::string>& more, const std::vector<std::string>& extra) const
{
    std::vector<std::string> words{program("hive-" + kind).string(), "--name", name};
    for (const auto& setting : settings)
        words.insert(words.end(), {"--set", setting});
    words.insert(words.end(), more.begin(), more.end());
    auto variables = environment();
    variables.insert(variables.end(), extra.begin(), extra.end());
    Process process(words, variables, home_ / (name + ".log"));
    Application asking = application(Milliseconds(500));
    const bool answers = eventually(
        [&] {
            if (process.wait(Milliseconds(0)))
                return true;
            if (!fs::exists(home_ / (name + ".sock")))
                return false;
            const auto answer = asking.status(std::vector{name}).at(0);
            const auto* status = value_of(answer.status);
            return status && status->pid == process.pid() && status->state != State::starting;
        },
        Milliseconds(10'000));
    if (!answers || process.wait(Milliseconds(0)))
        throw std::runtime_error("hive-" + kind + " as " + name + " did not start:\n" + log(name));
    return process;
}

fs::path Swarm::key_file() const { return home_ / "config/hive/swarm.key"; }

std::string Swarm::log(const std::string& name) const { return text_of(home_ / (name + ".log")); }

Application Swarm::application(Milliseconds timeout) const
{
    ::setenv("HIVE_KEY", "none", 1);  // of this process alone; without a key in the swarm the user's own is not read
    const auto key = fs::exists(key_file()) ? key_file() : fs::path();
    return Application({.name = {}, .home = home_, .timeout = stated(timeout), .key = key});
}

std::optional<fs::path> shared_data(const std::string& relative)
{
    const char* variable = std::getenv("HIVE_SHARED");
    const fs::path file = (variable ? fs::path(variable) : fs::path(HIVE_SOURCE_DIR) / "../shared") / relative;
    return fs::exists(file) ? std::optional(file) : std::nullopt;
}

}  // namespace hive::test
