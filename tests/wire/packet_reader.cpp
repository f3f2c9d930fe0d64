// The reader: prefix, limits, header.
#include "packet_reader.hpp"

#include <hive/json.hpp>
#include <hive/protocol/messages.hpp>

namespace hive::wire {

using protocol::PacketType;

void PacketReader::feed(std::string_view bytes)
{
    if (error_)
        return;
    pending_ += bytes;
    try {
        while (take_packet()) {
        }
    } catch (const Error& error) {
        error_ = error.code();
    }
}

bool PacketReader::take_packet()
{
    if (pending_.size() < protocol::prefix_size)
        return false;
    const auto* start = reinterpret_cast<const unsigned char*>(pending_.data());
    const auto prefix = protocol::decode_prefix(start, first_ ? protocol::hello_limits : protocol::Limits{});
    const std::size_t size = protocol::prefix_size + prefix.header_size + prefix.body_size;
    if (pending_.size() < size)
        return false;
    auto packet =
        protocol::make_packet(prefix.type, pending_.substr(protocol::prefix_size, prefix.header_size), prefix.channel,
                              Body(pending_.substr(protocol::prefix_size + prefix.header_size, prefix.body_size)));
    check(packet);
    pending_.erase(0, size);
    packets_.push_back(std::move(packet));
    first_ = false;
    return true;
}

void PacketReader::check(const protocol::Packet& packet) const
{
    if (first_ && packet.type != PacketType::hello)
        throw Error(Errc::malformed, "the first packet is no hello");
    if (packet.type == PacketType::ping || packet.type == PacketType::pong)
        return;
    if (packet.type == PacketType::release)
        return static_cast<void>(protocol::slots_from_body(packet.body));
    if (packet.type == PacketType::reference)
        static_cast<void>(protocol::reference_from_body(packet.body));
    if (!parse_json(packet.header_text()).is_object())
        throw Error(Errc::malformed, "the header is not an object");
}

}  // namespace hive::wire
