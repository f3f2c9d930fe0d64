// Finds the listening socket in the kernel's tables, and the process that has it open.
#include <hive/transport/port_holder.hpp>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>

namespace hive::transport {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view listening = "0A";

/// "socket:[INODE]" of the sockets that listen there, the text of links in /proc/PID/fd.
std::set<std::string> sockets_at(std::uint16_t port)
{
    std::set<std::string> found;
    for (const auto* table : {"/proc/self/net/tcp", "/proc/self/net/tcp6"}) {
        std::ifstream lines(table);
        for (std::string line; std::getline(lines, line);) {
            std::istringstream words(line);
            std::string slot, local, remote, state, queues, timer, retransmitted, user, timeout, inode;
            words >> slot >> local >> remote >> state >> queues >> timer >> retransmitted >> user >> timeout >> inode;
            std::uint16_t at = 0;
            const auto colon = local.rfind(':');
            if (state != listening || colon == std::string::npos)
                continue;
            std::from_chars(local.data() + colon + 1, local.data() + local.size(), at, 16);
            if (at == port)
                found.insert("socket:[" + inode + "]");
        }
    }
    return found;
}

bool has_one_of(const fs::path& process, const std::set<std::string>& sockets)
{
    std::error_code error;
    for (auto entry = fs::directory_iterator(process / "fd", error); !error && entry != fs::directory_iterator();
         entry.increment(error)) {
        std::error_code gone;
        if (sockets.contains(fs::read_symlink(entry->path(), gone).string()))
            return true;
    }
    return false;
}

}  // namespace

std::string holder_of_port(std::uint16_t port)
{
    const auto sockets = sockets_at(port);
    std::error_code error;
    for (auto entry = fs::directory_iterator("/proc", error);
         !sockets.empty() && !error && entry != fs::directory_iterator(); entry.increment(error)) {
        const auto pid = entry->path().filename().string();
        if (pid.find_first_not_of("0123456789") != std::string::npos || !has_one_of(entry->path(), sockets))
            continue;
        std::string program;
        std::getline(std::ifstream(entry->path() / "cmdline"), program, '\0');
        return fs::path(program).filename().string() + ", process " + pid;
    }
    return {};
}

}  // namespace hive::transport
