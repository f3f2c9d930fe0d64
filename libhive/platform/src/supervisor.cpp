// The protocol of sd_notify(3): datagrams to the socket that $NOTIFY_SOCKET names. libsystemd, which implements it too,
// is not available on every machine that loads this library.
#include <hive/platform/supervisor.hpp>

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace hive::platform {
namespace {

std::string_view variable(const char* name)
{
    const char* const value = std::getenv(name);
    return value ? value : "";
}

}  // namespace

void tell_supervisor(const std::string& news) noexcept
{
    const auto path = variable("NOTIFY_SOCKET");
    sockaddr_un address{};
    if (path.empty() || path.size() >= sizeof address.sun_path)
        return;
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    if (path.front() == '@')  // an abstract socket, not a file
        address.sun_path[0] = '\0';
    const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (socket < 0)
        return;
    // A supervisor that does not read must not block the drone: a message that cannot be sent at once is dropped.
    static_cast<void>(::sendto(socket, news.data(), news.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                               reinterpret_cast<const sockaddr*>(&address),
                               static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size())));
    ::close(socket);
}

/// Ignores $WATCHDOG_PID, which may be that of a wrapper of this process.
std::optional<std::chrono::microseconds> supervisor_timeout()
{
    const auto text = variable("WATCHDOG_USEC");
    std::int64_t time = 0;
    const auto [stop, problem] = std::from_chars(text.data(), text.data() + text.size(), time);
    if (problem != std::errc() || stop != text.data() + text.size() || time <= 0)
        return std::nullopt;
    return std::chrono::microseconds(time);
}

}  // namespace hive::platform
