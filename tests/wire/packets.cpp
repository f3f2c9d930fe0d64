// Packets and streams of packets, good and bad, whole and in slices.
#include "packet_reader.hpp"
#include "vectors.hpp"

namespace hive::wire {
namespace {

/// The same bytes in slices of `step`.
PacketReader read(std::string_view bytes, bool first, std::size_t step)
{
    PacketReader reader(first);
    for (; !bytes.empty(); bytes.remove_prefix(std::min(step, bytes.size())))
        reader.feed(bytes.substr(0, step));
    return reader;
}

std::string body_text(const Body& body) { return {reinterpret_cast<const char*>(body.data()), body.size()}; }

std::string encoded(const protocol::Packet& packet)
{
    const auto prefix = protocol::encode(packet.prefix());
    return std::string(prefix.begin(), prefix.end()) + std::string(packet.header_text()) + body_text(packet.body);
}

void check_packet(const Json& row, const protocol::Packet& packet, std::string_view bytes)
{
    CHECK_EQ(protocol::token(packet.type), row.at("type").get<std::string>());
    CHECK_EQ(packet.channel, row.at("channel").get<int>());
    if (row.contains("header"))
        CHECK_EQ(parse_json(packet.header_text()), row.at("header"));
    if (row.contains("body"))
        CHECK_EQ(to_hex(body_text(packet.body)), row.at("body").get<std::string>());
    CHECK(encoded(packet) == bytes);
    CHECK_EQ(packet.size(), bytes.size());
}

}  // namespace

TEST_CASE("packet vectors: each is read as written, or refused with its code")
{
    for (const auto& row : read_vectors("packets.jsonl", 80)) {
        CAPTURE(row.at("name"));
        const std::string bytes = input_of(row, true);
        const auto reader = read(bytes, row.value("first", false), bytes.size() + 1);
        check_outcome(row, reader.error());
        CHECK_EQ(reader.inside(), row.value("incomplete", false) && !bytes.empty());
        REQUIRE_EQ(reader.packets().size(), row.value("ok", false) ? 1u : 0u);
        if (row.value("ok", false))
            check_packet(row, reader.packets().front(), bytes);
    }
}

TEST_CASE("packet vectors: slicing the bytes changes nothing")
{
    for (const auto& row : read_vectors("packets.jsonl", 80)) {
        CAPTURE(row.at("name"));
        const std::string bytes = input_of(row, true);
        if (bytes.size() > 100'000)
            continue;
        const auto reader = read(bytes, row.value("first", false), bytes.size() > 10'000 ? 997 : 1);
        check_outcome(row, reader.error());
        CHECK_EQ(reader.packets().size(), row.value("ok", false) ? 1u : 0u);
    }
}

TEST_CASE("stream vectors: packets up to the first mistake, in any slices")
{
    for (const auto& row : read_vectors("streams.jsonl", 10)) {
        const std::string bytes = input_of(row, true);
        for (const std::size_t step : {std::size_t{1}, std::size_t{7}, std::size_t{16}, bytes.size() + 1}) {
            CAPTURE(row.at("name"));
            CAPTURE(step);
            const auto reader = read(bytes, true, step);
            check_outcome(row, reader.error());
            CHECK_EQ(reader.inside(), row.value("incomplete", false));
            Json types = Json::array();
            for (const auto& packet : reader.packets())
                types.push_back(protocol::token(packet.type));
            CHECK_EQ(types, row.at("packets"));
        }
    }
}

}  // namespace hive::wire
