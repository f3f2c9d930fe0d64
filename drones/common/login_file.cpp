// Opens the file before it checks it, so that the checked file is the one that is read.
#include "login_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace capture {
namespace {

class File {
public:
    explicit File(const std::string& path) : descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
    ~File()
    {
        if (descriptor >= 0)
            ::close(descriptor);
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    const int descriptor;
};

std::string text_of(const std::string& path)
{
    const File file(path);
    struct stat facts {};
    if (file.descriptor < 0 || ::fstat(file.descriptor, &facts) != 0)
        throw std::runtime_error("credentials: cannot open " + path + ": " + std::strerror(errno));
    if (!S_ISREG(facts.st_mode))
        throw std::runtime_error("credentials: " + path + " is not a file");
    if (facts.st_uid != ::geteuid() || (facts.st_mode & 077) != 0)
        throw std::runtime_error("credentials: others could read " + path + "; do: chmod 600 " + path
                                 + ", as its owner");
    std::array<char, 1024> buffer{};
    const auto size = ::read(file.descriptor, buffer.data(), buffer.size());
    return {buffer.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

/// Removes the first line from the text.
std::string next_line(std::string& text)
{
    const std::string line = text.substr(0, text.find_first_of("\r\n"));
    const auto next = text.find('\n');
    text.erase(0, next == std::string::npos ? next : next + 1);
    return line;
}

std::string variable(const char* name)
{
    const char* value = std::getenv(name);
    return value ? value : "";
}

/// A half-written login would be tried, and cameras count attempts.
std::optional<Credentials> credentials_of_environment(const CredentialVariables& names)
{
    const Credentials found{variable(names.user), variable(names.password), {}};
    if (found.user.empty() && found.password.empty())
        return std::nullopt;
    if (found.user.empty() || found.password.empty())
        throw std::runtime_error(std::string("credentials: ") + (found.user.empty() ? names.user : names.password)
                                 + " is missing in the environment, where "
                                 + (found.user.empty() ? names.password : names.user) + " is set");
    return found;
}

}  // namespace

std::optional<Credentials> read_credentials(const std::string& path, const CredentialVariables& variables)
{
    if (path.empty())
        return credentials_of_environment(variables);
    std::string text = text_of(path);
    const std::string line = next_line(text), camera = next_line(text);
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || colon == 0)
        throw std::runtime_error("credentials: the first line of " + path + " must be user:password");
    const bool says = camera.find("://") != std::string::npos;
    return Credentials{line.substr(0, colon), line.substr(colon + 1), says ? camera : ""};
}

std::filesystem::file_time_type written_at(const std::string& path)
{
    std::error_code none;
    return std::filesystem::last_write_time(path, none);
}

}  // namespace capture
