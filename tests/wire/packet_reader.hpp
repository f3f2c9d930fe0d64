// Packets out of a stream of bytes, as SPEC.md says it and as simply as can be: what real connections are compared
// with.
#pragma once

#include <hive/error.hpp>
#include <hive/protocol/packet.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hive::wire {

/// Fed with slices of any size; stops for good at the first mistake.
class PacketReader {
public:
    /// @param first  true: the stream begins here, so the first packet is a hello under the limits of hellos
    explicit PacketReader(bool first) : first_(first) {}

    void feed(std::string_view bytes);

    [[nodiscard]] const std::vector<protocol::Packet>& packets() const noexcept { return packets_; }
    [[nodiscard]] std::optional<Errc> error() const noexcept { return error_; }
    /// Has a packet begun that is not whole yet?
    [[nodiscard]] bool inside() const noexcept { return !error_ && !pending_.empty(); }

private:
    bool take_packet();
    void check(const protocol::Packet& packet) const;

    std::string pending_;
    std::vector<protocol::Packet> packets_;
    std::optional<Errc> error_;
    bool first_;
};

}  // namespace hive::wire
