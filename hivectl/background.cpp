// Starting with posix_spawn, which needs no care about threads between fork and exec.
#include "background.hpp"

#include <hive/error.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <spawn.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace hivectl {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

void require(int error, const std::string& what)
{
    if (error != 0)
        throw hive::Error(hive::Errc::io, "cannot " + what + ": " + std::strerror(error));
}

std::vector<char*> pointers(const std::vector<std::string>& texts)
{
    std::vector<char*> result;
    for (const auto& text : texts)
        result.push_back(const_cast<char*>(text.c_str()));  // the interface of exec is older than const
    result.push_back(nullptr);
    return result;
}

/// Our environment with some variables replaced.
std::vector<std::string> environment_with(const std::vector<std::string>& replacements)
{
    const auto same_variable = [](const std::string& a, const std::string& b) { return a.substr(0, a.find('=')) == b.substr(0, b.find('=')); };
    std::vector<std::string> result = replacements;
    for (char** variable = environ; *variable; ++variable)
        if (std::ranges::none_of(replacements, [&](const auto& replacement) { return same_variable(replacement, *variable); }))
            result.emplace_back(*variable);
    return result;
}

/// What the child's descriptors are.
class Descriptors {
public:
    explicit Descriptors(const fs::path& log)
    {
        require(posix_spawn_file_actions_init(&actions_), "prepare a process");
        posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW, 0600);
        posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
        posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
    }
    ~Descriptors() { posix_spawn_file_actions_destroy(&actions_); }
    Descriptors(const Descriptors&) = delete;
    Descriptors& operator=(const Descriptors&) = delete;
    const posix_spawn_file_actions_t* get() const { return &actions_; }

private:
    posix_spawn_file_actions_t actions_{};
};

/// A session of its own and no signal blocked or ignored.
class Attributes {
public:
    Attributes()
    {
        require(posix_spawnattr_init(&attributes_), "prepare a process");
        sigset_t none, all;
        sigemptyset(&none);
        sigfillset(&all);
        posix_spawnattr_setsigmask(&attributes_, &none);
        posix_spawnattr_setsigdefault(&attributes_, &all);
        posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    }
    ~Attributes() { posix_spawnattr_destroy(&attributes_); }
    Attributes(const Attributes&) = delete;
    Attributes& operator=(const Attributes&) = delete;
    const posix_spawnattr_t* get() const { return &attributes_; }

private:
    posix_spawnattr_t attributes_{};
};

std::uintmax_t size_or_zero(const fs::path& file)
{
    std::error_code missing;
    const auto size = fs::file_size(file, missing);
    return missing ? 0 : size;
}

}  // namespace

BackgroundProcess::BackgroundProcess(const fs::path& program, const std::vector<std::string>& arguments,
                                     const std::vector<std::string>& environment, const fs::path& log)
    : log_(log), log_begin_(size_or_zero(log))
{
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const auto variables = environment_with(environment);
    const Descriptors descriptors(log);
    const Attributes attributes;
    require(posix_spawn(&pid_, program.c_str(), descriptors.get(), attributes.get(), pointers(words).data(), pointers(variables).data()),
            "run " + program.string() + " with its log in " + log.string());
}

std::optional<int> BackgroundProcess::ended()
{
    int status = 0;
    if (!status_ && ::waitpid(pid_, &status, WNOHANG) == pid_)
        status_ = status;
    return status_;
}

void BackgroundProcess::end()
{
    // Not reaped yet, so the pid is still its own.
    if (!ended())
        ::kill(pid_, SIGTERM);
    for (int i = 0; i < 100 && !ended(); ++i)
        std::this_thread::sleep_for(10ms);
    if (!ended())
        ::kill(pid_, SIGKILL);
    while (!ended())
        std::this_thread::sleep_for(1ms);
}

std::string BackgroundProcess::last_words(std::size_t lines) const
{
    constexpr std::uintmax_t most = 16 * 1024;
    const auto size = size_or_zero(log_);
    std::ifstream file(log_, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(std::max(log_begin_, size > most ? size - most : 0)));
    std::vector<std::string> read;
    for (std::string line; std::getline(file, line);)
        read.push_back(line);
    std::string text;
    for (std::size_t i = read.size() > lines ? read.size() - lines : 0; i < read.size(); ++i)
        text += read[i] + "\n";
    return text;
}

}  // namespace hivectl
