// Encodes and checks prefixes.
#include "little_endian.hpp"

#include <hive/error.hpp>
#include <hive/protocol/packet.hpp>

#include <cstring>

namespace hive::protocol {
namespace {

/// Pings, pongs and releases have no header; pings and pongs have no body.
void require_bare(const Prefix& prefix)
{
    const bool beat = prefix.type == PacketType::ping || prefix.type == PacketType::pong;
    if ((prefix.header_size != 0 && (beat || prefix.type == PacketType::release)) || (prefix.body_size != 0 && beat))
        throw Error(Errc::malformed, "a " + std::string(token(prefix.type)) + " with a "
                                         + (prefix.header_size != 0 ? "header" : "body"));
}

}  // namespace

std::string_view token(PacketType type) noexcept
{
    switch (type) {
    case PacketType::hello: return "hello";
    case PacketType::ping: return "ping";
    case PacketType::pong: return "pong";
    case PacketType::register_receiver: return "register";
    case PacketType::deregister: return "deregister";
    case PacketType::request: return "request";
    case PacketType::segment: return "segment";
    case PacketType::release: return "release";
    case PacketType::event: return "event";
    case PacketType::notification: return "notification";
    case PacketType::exception: return "exception";
    case PacketType::reference: return "reference";
    case PacketType::end: return "end";
    case PacketType::connect: return "connect";
    case PacketType::disconnect: return "disconnect";
    case PacketType::set: return "set";
    case PacketType::get: return "get";
    case PacketType::describe: return "describe";
    case PacketType::status: return "status";
    case PacketType::halt: return "halt";
    case PacketType::resume: return "resume";
    case PacketType::stop: return "stop";
    case PacketType::put: return "put";
    case PacketType::forget: return "forget";
    case PacketType::confirmation: return "confirmation";
    }
    return {};
}

bool carries_body(PacketType type) noexcept
{
    return type == PacketType::event || type == PacketType::put || type == PacketType::reference
           || type == PacketType::release;
}

PrefixBytes encode(const Prefix& prefix) noexcept
{
    PrefixBytes bytes{};
    std::memcpy(bytes.data(), magic.data(), magic.size());
    bytes[4] = version;
    bytes[5] = static_cast<unsigned char>(prefix.type);
    store(&bytes[6], prefix.channel);
    store(&bytes[8], prefix.header_size);
    store(&bytes[12], prefix.body_size);
    return bytes;
}

Prefix decode_prefix(const unsigned char* bytes, const Limits& limits)
{
    if (std::memcmp(bytes, magic.data(), magic.size()) != 0)
        throw Error(Errc::malformed, "not a Hive packet: it does not start with HIVE");
    if (bytes[4] != version)
        throw Error(Errc::version_mismatch, "the peer uses version " + std::to_string(bytes[4])
                                                + " of the protocol, this end version " + std::to_string(version));
    Prefix prefix{static_cast<PacketType>(bytes[5]), load<std::uint16_t>(&bytes[6]), load<std::uint32_t>(&bytes[8]),
                  load<std::uint32_t>(&bytes[12])};
    if (token(prefix.type).empty())
        throw Error(Errc::malformed, "packet type " + std::to_string(bytes[5]) + " does not exist");
    require_bare(prefix);
    require_at_most("a header", prefix.header_size, limits.header);
    require_at_most("a body", prefix.body_size, limits.body);
    return prefix;
}

Prefix Packet::prefix() const
{
    return {type, channel, static_cast<std::uint32_t>(header_text().size()), static_cast<std::uint32_t>(body.size())};
}

Packet make_packet(PacketType type, std::string header, std::uint16_t channel, Body body)
{
    return {type, channel, std::make_shared<const std::string>(std::move(header)), std::move(body)};
}

}  // namespace hive::protocol
