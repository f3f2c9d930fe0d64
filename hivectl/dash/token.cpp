#include "token.hpp"

#include "words/file_text.hpp"

#include <hive/error.hpp>
#include <hive/http/pass.hpp>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace hivectl::dash {

/// Written under another name and then linked, so that two processes that start at once get the same token.
std::string lasting_token(const std::filesystem::path& file)
{
    constexpr std::size_t max_bytes = 64, length = 32;
    const auto part = file.string() + "." + std::to_string(::getpid());
    const auto token = hive::http::Pass::draw_token();
    const int descriptor = ::open(part.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600);
    const bool written =
        descriptor >= 0 && ::write(descriptor, token.data(), token.size()) == static_cast<ssize_t>(token.size());
    const bool linked = written && (::link(part.c_str(), file.c_str()) == 0 || errno == EEXIST);
    const std::string problem = std::strerror(errno);
    ::close(descriptor);
    ::unlink(part.c_str());
    if (!linked)
        throw hive::Error(hive::Errc::io, "cannot write " + file.string() + ": " + problem);
    auto kept = text_of_file(file.string(), max_bytes);
    if (kept.size() != length)
        throw hive::Error(hive::Errc::malformed, file.string() + " holds no token", "remove it: rm " + file.string());
    return kept;
}

}  // namespace hivectl::dash
