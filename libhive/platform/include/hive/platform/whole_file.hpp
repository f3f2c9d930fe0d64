// Writes a file under another name and renames it, so that no reader sees a part of it.
#pragma once

#include <hive/platform/process.hpp>

#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <string_view>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace hive::platform {

struct WholeFile {
    mode_t mode = 0600;    ///< less the umask
    bool replaces = true;  ///< false: std::errc::file_exists if there is such a file
    bool durable = false;  ///< the bytes are on the disk before the file has its name
};

namespace detail {

inline std::error_code last_error() { return {errno, std::generic_category()}; }

inline std::error_code write_all(int descriptor, std::string_view bytes)
{
    while (!bytes.empty()) {
        const auto written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno != EINTR)
            return last_error();
        bytes.remove_prefix(written > 0 ? static_cast<std::size_t>(written) : 0);
    }
    return {};
}

}  // namespace detail

/// @return  the reason of a failure, which changes nothing
[[nodiscard]] inline std::error_code write_whole(const std::filesystem::path& file, std::string_view bytes,
                                                 WholeFile how = {})
{
    const auto fresh = file.string() + "." + std::to_string(own_pid()) + ".new";
    ::unlink(fresh.c_str());  // left by a killed process with this pid
    const int opened = ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, how.mode);
    if (opened < 0)
        return detail::last_error();
    auto problem = detail::write_all(opened, bytes);
    if (!problem && how.durable && ::fsync(opened) != 0)
        problem = detail::last_error();
    if (::close(opened) != 0 && !problem)
        problem = detail::last_error();
    if (!problem && (how.replaces ? ::rename : ::link)(fresh.c_str(), file.c_str()) != 0)
        problem = detail::last_error();
    if (problem || !how.replaces)
        ::unlink(fresh.c_str());
    return problem;
}

}  // namespace hive::platform
