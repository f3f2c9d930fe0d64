// Reads logs of processes, and describes how they exited.
#include "background_process.hpp"

#include <hive/process.hpp>
#include <hive/transport/descriptor.hpp>

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <fstream>
#include <sys/wait.h>
#include <utility>

namespace hive {
namespace {

namespace fs = std::filesystem;

std::uintmax_t size_or_zero(const fs::path& file)
{
    std::error_code missing;
    const auto size = fs::file_size(file, missing);
    return missing ? 0 : size;
}

Child started(const fs::path& program, std::vector<std::string> words, const std::vector<std::string>& environment,
              const fs::path& log, bool tied)
{
    const transport::Descriptor out(::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0600));
    require_done(!out ? errno : 0, "open the log " + log.string());
    words.insert(words.begin(), program.string());
    return Child(
        {.words = std::move(words), .environment = environment, .out = out.get(), .err = out.get(), .tied = tied});
}

}  // namespace

LogFromNow::LogFromNow(fs::path file) : file_(std::move(file)), begin_(size_or_zero(file_)) {}

/// The drone rotated a log that is shorter than before: all of it is of this run.
std::string LogFromNow::last_lines() const
{
    constexpr std::size_t lines = 15;
    return hive::last_lines(file_, lines, begin_ <= size_or_zero(file_) ? begin_ : 0);
}

BackgroundProcess::BackgroundProcess(const fs::path& program, const std::vector<std::string>& arguments,
                                     const std::vector<std::string>& environment, LogFromNow log, Life life)
    : Child(started(program, arguments, environment, log.file(), life == Life::tied)), log_(std::move(log))
{
}

std::string how_it_ended(int status)
{
    return WIFSIGNALED(status) ? "was killed by signal " + std::to_string(WTERMSIG(status))
                               : "ended with exit code " + std::to_string(WEXITSTATUS(status));
}

std::string how_its_start_ended(int status)
{
    return how_it_ended(status) + " before it was ready"
           + (status == 0 ? " (the drone must call run(), which returns when it is stopped)" : "");
}

std::string last_lines(const std::filesystem::path& log, std::size_t lines, std::uintmax_t begin)
{
    constexpr std::uintmax_t most = 16 * 1024;
    const auto size = size_or_zero(log);
    std::ifstream file(log, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(std::max(begin, size > most ? size - most : 0)));
    std::vector<std::string> read;
    for (std::string line; std::getline(file, line);)
        read.push_back(line);
    std::string text;
    for (std::size_t i = read.size() > lines ? read.size() - lines : 0; i < read.size(); ++i)
        text += read[i] + "\n";
    return text;
}

}  // namespace hive
