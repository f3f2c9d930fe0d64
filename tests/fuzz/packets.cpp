// A stream of packets: fed whole and in slices it gives the same packets and the same end, and what was read is written
// back. Input: one byte for the slicing and whether the stream begins here, then the stream.
#include "packet_reader.hpp"
#include "require.hpp"

#include <cstring>

namespace {

using hive::fuzz::require;
using hive::wire::PacketReader;

PacketReader in_slices(std::string_view stream, bool first, unsigned seed)
{
    PacketReader reader(first);
    while (!stream.empty()) {
        seed = seed * 1103515245u + 12345u;
        const auto slice = stream.substr(0, 1 + (seed >> 16) % 24);
        reader.feed(slice);
        stream.remove_prefix(slice.size());
    }
    return reader;
}

bool same(const hive::protocol::Packet& a, const hive::protocol::Packet& b)
{
    return a.type == b.type && a.channel == b.channel && a.header_text() == b.header_text()
           && a.body.size() == b.body.size()
           && (a.body.empty() || std::memcmp(a.body.data(), b.body.data(), a.body.size()) == 0);
}

void require_written_back(std::string_view stream, const PacketReader& reader)
{
    for (const auto& packet : reader.packets()) {
        const auto prefix = hive::protocol::encode(packet.prefix());
        require(stream.size() >= packet.size(), "packets come from the stream");
        require(std::memcmp(stream.data(), prefix.data(), prefix.size()) == 0, "a prefix is written as it was read");
        stream.remove_prefix(packet.size());
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    if (size == 0)
        return 0;
    const std::string_view stream(reinterpret_cast<const char*>(bytes) + 1, size - 1);
    const bool first = bytes[0] & 1;
    PacketReader whole(first);
    whole.feed(stream);
    const auto sliced = in_slices(stream, first, bytes[0]);
    require(whole.error() == sliced.error() && whole.inside() == sliced.inside(), "slices end as the whole does");
    require(whole.packets().size() == sliced.packets().size(), "slices give as many packets");
    for (std::size_t i = 0; i < whole.packets().size(); ++i)
        require(same(whole.packets()[i], sliced.packets()[i]), "slices give the same packets");
    require_written_back(stream, whole);
    return 0;
}
