// Prefixes at their edges; packets share header and body.
#include <hive/error.hpp>
#include <hive/protocol/packet.hpp>

#include <doctest/doctest.h>

using namespace hive;
using namespace hive::protocol;

namespace {

Errc refusal(PrefixBytes bytes, const Limits& limits = {})
{
    try {
        (void)decode_prefix(bytes.data(), limits);
    } catch (const Error& error) {
        return error.code();
    }
    return Errc::failed;
}

}  // namespace

TEST_CASE("prefix: every field survives the way, at its smallest and largest")
{
    const Limits all{.header = UINT32_MAX, .body = UINT32_MAX};
    for (const auto type : {PacketType::hello, PacketType::event, PacketType::confirmation})
        for (const std::uint16_t channel : {0, 1, 255, 256, 65535})
            for (const std::uint32_t size : {0u, 1u, 255u, 65536u, UINT32_MAX}) {
                const Prefix back = decode_prefix(encode({type, channel, size, UINT32_MAX - size}).data(), all);
                CHECK_EQ(back.type, type);
                CHECK_EQ(back.channel, channel);
                CHECK_EQ(back.header_size, size);
                CHECK_EQ(back.body_size, UINT32_MAX - size);
            }
}

TEST_CASE("prefix: any single bit changed in magic or version is noticed")
{
    const auto good = encode({PacketType::ping, 0, 0, 0});
    for (std::size_t bit = 0; bit < 40; ++bit) {
        auto bytes = good;
        bytes[bit / 8] ^= static_cast<unsigned char>(1u << (bit % 8));
        CHECK_EQ(refusal(bytes), bit < 32 ? Errc::malformed : Errc::version_mismatch);
    }
}

TEST_CASE("prefix: a mismatch of versions names both")
{
    auto bytes = encode({PacketType::ping, 0, 0, 0});
    bytes[4] = 9;
    CHECK_THROWS_WITH_AS((void)decode_prefix(bytes.data(), {}),
                         "the peer uses version 9 of the protocol, this end version 1", Error);
}

TEST_CASE("prefix: the limits are those of the caller")
{
    const auto bytes = encode({PacketType::event, 1, 100, 1000});
    CHECK_NOTHROW((void)decode_prefix(bytes.data(), {.header = 100, .body = 1000}));
    CHECK_EQ(refusal(bytes, {.header = 99, .body = 1000}), Errc::too_large);
    CHECK_EQ(refusal(bytes, {.header = 100, .body = 999}), Errc::too_large);
    CHECK_EQ(refusal(bytes, hello_limits), Errc::too_large);
}

TEST_CASE("packet: copies share header and body")
{
    const Packet packet = make_packet(PacketType::event, "{}", 3, Body(std::string(100, 'b')));
    const Packet copy = packet;
    CHECK_EQ(copy.header_text().data(), packet.header_text().data());
    CHECK_EQ(copy.body.data(), packet.body.data());
    CHECK_EQ(copy.size(), 16u + 2u + 100u);
    CHECK_EQ(copy.prefix().body_size, 100u);
}

TEST_CASE("packet: one without header is a prefix")
{
    CHECK_EQ(Packet{.type = PacketType::ping, .channel = 0, .header = nullptr, .body = {}}.size(), prefix_size);
    CHECK_EQ(make_packet(PacketType::ping, "").prefix().header_size, 0u);
}
