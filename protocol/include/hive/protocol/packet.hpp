// The packet: a prefix of 16 bytes, a JSON header, a binary body (SPEC.md, section 2).
#pragma once

#include <hive/body.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace hive::protocol {

inline constexpr std::uint8_t version = 1;
inline constexpr std::size_t prefix_size = 16;
inline constexpr std::array<char, 4> magic{'H', 'I', 'V', 'E'};

/// The packet types; the numbers are on the wire (SPEC.md, section 2).
enum class PacketType : std::uint8_t {
    hello = 1,
    ping = 2,
    pong = 3,
    // from receiver to sender, about one channel
    register_receiver = 10,
    deregister = 11,
    request = 12,
    // about bodies in shared memory (section 11): the sender's offer, the receiver's release
    segment = 13,
    release = 14,
    // from sender to receiver, on a channel
    event = 20,
    notification = 21,
    exception = 22,
    reference = 23,  ///< an event whose body lies in shared memory
    end = 24,        ///< nothing more will come
    // requests to a drone, each answered by one confirmation
    connect = 30,
    disconnect = 31,
    set = 32,
    get = 33,
    describe = 34,
    status = 35,
    halt = 36,
    resume = 37,
    stop = 38,
    put = 39,
    forget = 40,  ///< to a sender: stop waiting for a receiver that is gone
    confirmation = 50,
};

/// The token of a type as SPEC.md writes it ("register", "event"), or empty for an unknown number.
std::string_view token(PacketType type) noexcept;

/// May packets of this type have a body? The body of any other type is read and ignored.
bool carries_body(PacketType type) noexcept;

/// The sizes this end accepts, checked in the prefix, before anything is allocated.
struct Limits {
    std::uint32_t header = 64 * 1024;
    std::uint32_t body = 64 * 1024 * 1024;
};
/// For the first packet of a peer, before it is known.
inline constexpr Limits hello_limits{.header = 4096 - prefix_size, .body = 0};

struct Prefix {
    PacketType type{};
    std::uint16_t channel = 0;  ///< the registration an event, notification, exception or request belongs to; else 0
    std::uint32_t header_size = 0;
    std::uint32_t body_size = 0;
};

using PrefixBytes = std::array<unsigned char, prefix_size>;

PrefixBytes encode(const Prefix& prefix) noexcept;

/// Throws Errc::malformed (magic, type), Errc::version_mismatch naming both versions, Errc::too_large.
/// @param bytes  prefix_size bytes
Prefix decode_prefix(const unsigned char* bytes, const Limits& limits);

/// A whole packet, as received or to be sent. The header is JSON text, shared by all packets that carry it.
struct Packet {
    PacketType type{};
    std::uint16_t channel = 0;
    std::shared_ptr<const std::string> header;
    Body body;

    [[nodiscard]] std::string_view header_text() const
    {
        return header ? std::string_view(*header) : std::string_view();
    }
    [[nodiscard]] std::size_t size() const { return prefix_size + header_text().size() + body.size(); }
    [[nodiscard]] Prefix prefix() const;
};

Packet make_packet(PacketType type, std::string header, std::uint16_t channel = 0, Body body = {});

}  // namespace hive::protocol
