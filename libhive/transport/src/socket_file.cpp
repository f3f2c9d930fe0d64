// Binds, probes and removes the file of a unix socket.
#include "socket_file.hpp"

#include "socket_stream.hpp"

#include <hive/transport/folder_lock.hpp>

#include <cstring>
#include <filesystem>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hive::transport {
namespace {

Error failure(const Address& address, Errc code, const std::string& why)
{
    return {code, "cannot listen on " + to_text(address) + ": " + why};
}

Error os_failure(const Address& address, const std::string& what)
{
    const int error = errno;
    const auto code = error == EACCES || error == EPERM ? Errc::not_permitted : Errc::io;
    return failure(address, code, (what.empty() ? what : what + ": ") + os_text(error));
}

/// So that of two modules that find the same stale file only one replaces it.
FolderLock locked_folder(const Address& address)
try {
    const auto folder = std::filesystem::path(address.host).parent_path();
    return FolderLock(folder.empty() ? "." : folder);
} catch (const Error& error) {
    throw failure(address, error.code(), error.what());
}

/// Whether a module answers at the path. A full queue is an answer too.
bool is_answered(const sockaddr_un& at)
{
    const Descriptor probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (!probe)
        throw Error(Errc::io, "cannot open a socket: " + os_text(errno));
    return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0 || errno != ECONNREFUSED;
}

void remove_stale(const sockaddr_un& at, const Address& address)
{
    struct stat found {};
    if (::lstat(at.sun_path, &found) != 0) {
        if (errno == ENOENT)
            return;
        throw os_failure(address, {});
    }
    if (!S_ISSOCK(found.st_mode))
        throw failure(address, Errc::name_taken, "the file there is not a socket");
    if (is_answered(at))
        throw failure(address, Errc::name_taken, "another module listens there");
    if (::unlink(at.sun_path) != 0 && errno != ENOENT)
        throw os_failure(address, "the stale socket cannot be removed");
}

}  // namespace

sockaddr_un socket_address(const std::string& path)
{
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.empty() || path.size() >= sizeof address.sun_path)
        throw Error(Errc::invalid_argument, "the path of a unix socket has 1 to "
                                                + std::to_string(sizeof address.sun_path - 1) + " bytes, this one has "
                                                + std::to_string(path.size()) + ": " + path);
    std::memcpy(address.sun_path, path.data(), path.size());
    return address;
}

SocketFile SocketFile::bind_and_listen(int descriptor, const Address& address)
{
    const auto at = socket_address(address.host);
    const auto lock = locked_folder(address);
    remove_stale(at, address);
    // On Linux the file takes its mode from the unbound socket, so it is never open to others, not even briefly.
    if (::fchmod(descriptor, 0600) != 0)
        throw os_failure(address, {});
    if (::bind(descriptor, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
        throw errno == EADDRINUSE ? failure(address, Errc::name_taken, "the path is taken") : os_failure(address, {});
    SocketFile file(address.host);
    if (::listen(descriptor, SOMAXCONN) != 0)
        throw os_failure(address, {});
    return file;
}

SocketFile::SocketFile(std::string path) : path_(std::move(path))
{
    struct stat made {};
    if (::lstat(path_.c_str(), &made) == 0) {
        device_ = made.st_dev;
        inode_ = made.st_ino;
    }
}

SocketFile::SocketFile(SocketFile&& other) noexcept
    : path_(std::exchange(other.path_, {})), device_(other.device_), inode_(other.inode_)
{
}

SocketFile::~SocketFile()
{
    struct stat found {};
    if (!path_.empty() && ::lstat(path_.c_str(), &found) == 0 && found.st_dev == device_ && found.st_ino == inode_)
        ::unlink(path_.c_str());
}

}  // namespace hive::transport
