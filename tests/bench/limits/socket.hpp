// Blocking stream sockets on this machine: meeting, writing a gather list, reading a length and its bytes.
#pragma once

#include "../harness/run.hpp"

#include <cstddef>
#include <span>
#include <sys/uio.h>

namespace hive::bench {

/// An open socket, closed at the end. "unix" in the variant: an abstract unix socket, otherwise TCP on 127.0.0.1
/// without Nagle's delay; "b256": 256 KB of buffer in each direction instead of what the kernel chooses.
class Socket {
public:
    static Socket listen(const Run& run);
    /// Tries for 5 s.
    static Socket connect(const Run& run);
    [[nodiscard]] Socket accept(const Run& run) const;

    explicit Socket(int descriptor) : descriptor_(descriptor) {}
    ~Socket();
    Socket(Socket&& other) noexcept;
    Socket& operator=(Socket&&) = delete;

    /// Writes all parts. Throws std::runtime_error when the peer is gone.
    void write(std::span<iovec> parts) const;
    /// Fills `into`; false at the end of the stream.
    [[nodiscard]] bool read(std::span<std::byte> into) const;

private:
    int descriptor_;
};

}  // namespace hive::bench
