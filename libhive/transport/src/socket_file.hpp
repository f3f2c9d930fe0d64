// The file of a listening unix socket: replaces a stale one, never a live one, and is removed only by its owner.
#pragma once

#include <hive/transport/address.hpp>

#include <sys/types.h>
#include <sys/un.h>

#include <string>

namespace hive::transport {

/// The address of a path. Throws Errc::invalid_argument when it is too long for the kernel.
sockaddr_un socket_address(const std::string& path);

/// Owns the file, not the socket.
class SocketFile {
public:
    /// Binds `descriptor` to the path with mode 0600 and listens. Throws Errc::name_taken when another listener answers
    /// there or the file is not a socket, invalid_argument, not_permitted, io.
    static SocketFile bind_and_listen(int descriptor, const Address& address);

    SocketFile(SocketFile&& other) noexcept;
    SocketFile& operator=(SocketFile&&) = delete;
    ~SocketFile();

private:
    explicit SocketFile(std::string path);

    std::string path_;  ///< empty: moved from
    dev_t device_ = 0;
    ino_t inode_ = 0;
};

}  // namespace hive::transport
