// Framing without a socket: every cut of the bytes gives the same packets.
#include "packet_reader.hpp"
#include "packet_writer.hpp"

#include <hive/error.hpp>

#include <doctest/doctest.h>

#include <cstring>

using namespace hive::transport;
using hive::protocol::make_packet;
using hive::protocol::Packet;
using hive::protocol::PacketType;

namespace {

std::string drain(PacketWriter& writer)
{
    std::string bytes;
    while (!writer.idle()) {
        std::size_t count = 0;
        for (const auto& buffer : writer.gather()) {
            bytes.append(static_cast<const char*>(buffer.data()), buffer.size());
            count += buffer.size();
        }
        writer.wrote(count);
    }
    return bytes;
}

/// Reads in pieces of at most `piece` bytes; "type header body-size" of each packet.
std::vector<std::string> read_in_pieces(const std::string& bytes, std::size_t piece)
{
    PacketReader reader;
    std::vector<std::string> seen;
    for (std::size_t at = 0; at < bytes.size();) {
        const auto space = reader.space();
        REQUIRE(space.size() > 0);
        const auto count = std::min({piece, space.size(), bytes.size() - at});
        std::memcpy(space.data(), bytes.data() + at, count);
        at += count;
        reader.received(count);
        while (auto packet = reader.next()) {
            reader.open({});
            const std::string body(reinterpret_cast<const char*>(packet->body.data()), packet->body.size());
            seen.push_back(std::string(token(packet->type)) + " " + std::string(packet->header_text()) + " " + body);
        }
    }
    CHECK_FALSE(reader.inside());
    return seen;
}

}  // namespace

TEST_CASE("packet reader: every size of pieces gives the same packets")
{
    PacketWriter writer;
    writer.push(make_packet(PacketType::hello, "{}"), {});
    for (int i = 0; i < 20; ++i)
        writer.push(make_packet(PacketType::event, std::to_string(i), 3,
                                std::string(static_cast<std::size_t>(i * i * 97), static_cast<char>('a' + i))),
                    {});
    const auto bytes = drain(writer);
    const auto whole = read_in_pieces(bytes, bytes.size());
    REQUIRE(whole.size() == 21);
    for (std::size_t piece = 1; piece < 80; ++piece)
        CHECK(read_in_pieces(bytes, piece) == whole);
    CHECK(read_in_pieces(bytes, 16 * 1024) == whole);
}

TEST_CASE("packet reader: what is no Hive is told by the same sentence in every size of pieces")
{
    const auto refusal = [](const std::string& bytes, std::size_t piece) -> std::string {
        try {
            read_in_pieces(bytes, piece);
        } catch (const hive::Error& error) {
            return error.what();
        }
        return "";
    };
    for (const std::string opening : {"\x16\x03\x01", "\x15\x03\x03", "\x16\x04\x01", "GET / HTTP/1.1", "HIVX"}) {
        const auto whole = refusal(opening, opening.size());
        CHECK_FALSE(whole.empty());
        CHECK(refusal(opening, 1) == whole);
    }
}

TEST_CASE("packet reader: inside a body it asks for all that is missing")
{
    PacketReader reader;
    const auto give = [&](const std::string& bytes) {
        std::memcpy(reader.space().data(), bytes.data(), bytes.size());
        reader.received(bytes.size());
    };
    const auto prefix = [](PacketType type, std::uint32_t header, std::uint32_t body) {
        const auto bytes = encode(hive::protocol::Prefix{type, 0, header, body});
        return std::string(bytes.begin(), bytes.end());
    };
    give(prefix(PacketType::hello, 0, 0));
    REQUIRE(reader.next());
    reader.open({});
    give(prefix(PacketType::event, 1, 1'000'000) + "h" + std::string(1000, 'b'));
    CHECK_FALSE(reader.next());
    CHECK(reader.space().size() == 999'000);
    CHECK(reader.inside());
    CHECK(reader.progress() == "1000 of 1000000 bytes of its body");
}

TEST_CASE("packet writer: control goes before events, and before what of a batch has not begun")
{
    PacketWriter writer;
    writer.push(make_packet(PacketType::event, "e1"), {});
    writer.push(make_packet(PacketType::event, "e2"), {});
    CHECK(asio::buffer_size(writer.gather()) == 36);
    writer.push(make_packet(PacketType::get, "c1"), {});
    writer.wrote(5);  // e1 has begun, e2 has not
    std::string bytes;
    for (const auto& buffer : writer.gather())
        bytes.append(static_cast<const char*>(buffer.data()), buffer.size());
    CHECK(bytes.find("e1") < bytes.find("c1"));
    CHECK(bytes.find("c1") < bytes.find("e2"));
    CHECK(writer.control_bytes() == 18);
}

TEST_CASE("packet writer: batches are bounded by 16 packets and 64 KiB, and copy no body")
{
    PacketWriter writer;
    for (int i = 0; i < 40; ++i)
        writer.push(make_packet(PacketType::get, "c"), {});
    CHECK(asio::buffer_size(writer.gather()) == 16 * 17);
    writer.drop();
    const hive::Body big(std::string(100'000, 'x'));
    writer.push(make_packet(PacketType::event, "1", 0, big), {});
    writer.push(make_packet(PacketType::event, "2", 0, big), {});
    const auto batch = writer.gather();
    REQUIRE(batch.size() == 3);
    CHECK(batch[2].data() == big.data());
}

TEST_CASE("packet writer: callbacks come once each, when the last byte is out or at the end")
{
    PacketWriter writer;
    int called = 0;
    for (int i = 0; i < 3; ++i)
        writer.push(make_packet(PacketType::event, "12"), [&](bool) { ++called; });
    writer.gather();
    CHECK(writer.wrote(17).empty());
    writer.gather();
    CHECK(writer.wrote(1).size() == 1);
    writer.gather();
    CHECK(writer.drop().size() == 2);
    CHECK(writer.drop().empty());
    CHECK(writer.idle());
    CHECK(called == 0);  // calling them is for who asked
}
