// What a bad peer can do: nothing but lose its connection, in time, with the reason.
#include "transport_world.hpp"

#include <switched_off.hpp>

#include <asio/steady_timer.hpp>
#include <type_traits>

using namespace world;
using hive::test::SwitchedOff;

namespace {

struct Opening {
    std::string bytes;
    Errc expected;
};

std::string with_byte(std::string bytes, std::size_t at, int value)
{
    bytes[at] = static_cast<char>(value);
    return bytes;
}

std::vector<Opening> wrong_openings()
{
    std::vector<Opening> openings;
    for (const std::string& text : {std::string("GET / HTTP/1.1\r\nHost: a\r\n\r\n"),
                                    std::string("POST / HTTP/1.1\r\n\r\nHIVE"),
                                    std::string("G"),
                                    std::string("\n"),
                                    std::string("\x80\x2e\x01\x00\x02", 5),
                                    std::string(1, '\0'),
                                    std::string(4096, '\0'),
                                    std::string(16, '\xff'),
                                    std::string("SSH-2.0-OpenSSH_9.2\r\n"),
                                    std::string("hive"),
                                    std::string("HIVe"),
                                    std::string("HI"
                                                "E"),
                                    std::string("EVIH\x01\x01"),
                                    std::string("{\"name\":\"a\"}"),
                                    std::string("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"),
                                    std::string("\xff\x00\x00\x00\x00\x00\x00\x00\x01\x7f", 10),
                                    std::string("\xef\xbb\xbfHIVE"),
                                    std::string(" HIVE"),
                                    std::string("*1\r\n$4\r\nPING\r\n"),
                                    std::string("EHLO a\r\n"),
                                    std::string(100'000, 'A'),
                                    std::string("H\0I\0V\0E\0", 8)})
        openings.push_back({text, Errc::malformed});
    for (const std::string& tls : {std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11),
                                   std::string("\x15\x03\x03\x00\x02\x02\x28", 7)})  // it has a key, this end none
        openings.push_back({tls, Errc::not_permitted});
    for (const int version : {0, 2, 3, 127, 255})
        openings.push_back({with_byte(hello(), 4, version), Errc::version_mismatch});
    for (const int number : {0, 4, 9, 15, 19, 60, 200, 255})  // types that do not exist
        openings.push_back({with_byte(hello(), 5, number), Errc::malformed});
    for (const auto type : {PacketType::ping, PacketType::pong, PacketType::event, PacketType::get,
                            PacketType::confirmation, PacketType::stop, PacketType::put, PacketType::request})
        openings.push_back({prefix(type, 0, 0), Errc::malformed});
    for (const std::uint32_t size : {4081U, 65536U, 0x7fffffffU, 0xffffffffU})
        openings.push_back({prefix(PacketType::hello, size, 0), Errc::too_large});
    for (const std::uint32_t size : {1U, 0xffffffffU})
        openings.push_back({prefix(PacketType::hello, 2, size), Errc::too_large});
    return openings;
}

/// The memory that four bodies of 64 MiB take before anything of them has come.
std::int64_t cost_of_promises(Address (*address)(const Folder&))
{
    std::vector<std::unique_ptr<RawPair>> pairs;
    const auto before = resident_bytes();
    for (int i = 0; i < 4; ++i) {
        pairs.push_back(std::make_unique<RawPair>(address, patient));
        pairs.back()->write(hello() + prefix(PacketType::event, 2, 64U << 20) + "{}");
        REQUIRE(pairs.back()->loop.until([&] { return pairs.back()->end.has(1); }));
        pairs.back()->loop.run_for(20ms);
    }
    return static_cast<std::int64_t>(resident_bytes()) - static_cast<std::int64_t>(before);
}

/// Bytes of one packet, a few at a time, for two seconds or until the other end has had enough.
void trickle(RawPair& pair)
{
    pair.write(hello() + prefix(PacketType::event, 2, 1U << 20) + "{}");
    for (int i = 0; i < 200 && pair.end.closed == 0 && pair.write("some bytes"); ++i)
        pair.loop.run_for(10ms);
}

}  // namespace

TEST_CASE_TEMPLATE("bad peer: every wrong opening is closed at once with its reason", Place, Unix, Tcp)
{
    const auto openings = wrong_openings();
    REQUIRE(openings.size() >= 40);
    for (const auto& opening : openings) {
        CAPTURE(opening.bytes.substr(0, 40));
        RawPair pair(Place::address, patient);
        pair.write(opening.bytes);
        REQUIRE(pair.until_closed());
        CHECK(pair.end.code == opening.expected);
        CHECK(pair.end.packets.empty());
    }
}

TEST_CASE_TEMPLATE("bad peer: when the first bytes are not looked at, a short wrong opening stays", Place, Unix, Tcp)
{
    const SwitchedOff first_bytes("first-bytes");
    RawPair pair(Place::address, patient);
    pair.write("GET /\r\n");
    CHECK_FALSE(pair.until_closed(300ms));
}

TEST_CASE_TEMPLATE("bad peer: a version mismatch names both versions", Place, Unix, Tcp)
{
    RawPair pair(Place::address, patient);
    pair.write(with_byte(hello(), 4, 9));
    REQUIRE(pair.until_closed());
    CHECK(pair.end.text.find("version 9") != std::string::npos);
    CHECK(pair.end.text.find("version 1") != std::string::npos);
}

TEST_CASE_TEMPLATE("bad peer: a second hello is malformed", Place, Unix, Tcp)
{
    RawPair pair(Place::address, patient);
    pair.write(hello() + hello());
    REQUIRE(pair.until_closed());
    CHECK(pair.end.code == Errc::malformed);
    CHECK(pair.end.packets.size() == 1);
}

TEST_CASE_TEMPLATE("bad peer: sizes over the limit are refused from the prefix and cost no memory", Place, Unix, Tcp)
{
    RawPair warm(Place::address, patient);  // so that the first use of things is not counted
    warm.write(hello());
    REQUIRE(warm.loop.until([&] { return warm.end.has(1); }));
    const auto before = resident_bytes();
    for (const auto& lie : {prefix(PacketType::event, 2, (64U << 20) + 1), prefix(PacketType::event, 0, 0xffffffffU),
                            prefix(PacketType::event, 65537, 0), prefix(PacketType::event, 0xffffffffU, 0xffffffffU)}) {
        RawPair pair(Place::address, patient);
        pair.write(hello() + lie);
        REQUIRE(pair.until_closed());
        CHECK(pair.end.code == Errc::too_large);
    }
    if (!sanitized)
        CHECK(resident_bytes() < before + (2U << 20));
}

TEST_CASE_TEMPLATE("bad peer: a promised body that never comes costs no memory", Place, Unix, Tcp)
{
    const auto bytes = cost_of_promises(Place::address);
    if (!sanitized)
        CHECK(bytes < 2 << 20);
}

TEST_CASE_TEMPLATE("bad peer: when the pages of a promised body are touched, the promise costs memory", Place, Unix,
                   Tcp)
{
    const SwitchedOff untouched("untouched-bodies");
    const auto bytes = cost_of_promises(Place::address);
    if (!sanitized)
        CHECK(bytes > 200 << 20);
}

TEST_CASE_TEMPLATE("bad peer: who says no hello is closed in time", Place, Unix, Tcp)
{
    RawPair pair(Place::address, hasty);
    const auto begin = std::chrono::steady_clock::now();
    REQUIRE(pair.until_closed());
    CHECK(std::chrono::steady_clock::now() - begin < hasty.first_packet + 5s);
    CHECK(pair.end.code == Errc::timeout);
    CHECK(pair.end.text.find("no hello within 120 ms") != std::string::npos);
}

TEST_CASE_TEMPLATE("bad peer: without a deadline for the hello, silent strangers stay", Place, Unix, Tcp)
{
    const SwitchedOff deadline("hello-deadline");
    RawPair pair(Place::address, hasty);
    CHECK_FALSE(pair.until_closed(5 * hasty.first_packet));
}

TEST_CASE_TEMPLATE("bad peer: a hello byte by byte is closed at the deadline", Place, Unix, Tcp)
{
    RawPair pair(Place::address, hasty);
    const auto begin = std::chrono::steady_clock::now();
    for (const char byte : hello()) {
        if (pair.end.closed > 0 || !pair.write(std::string(1, byte)))
            break;
        pair.loop.run_for(10ms);
    }
    REQUIRE(pair.until_closed());
    CHECK(std::chrono::steady_clock::now() - begin < hasty.first_packet + 5s);
    CHECK(pair.end.code == Errc::timeout);
    CHECK(pair.end.packets.empty());
}

TEST_CASE_TEMPLATE("bad peer: silence after the hello is death", Place, Unix, Tcp)
{
    RawPair pair(Place::address, hasty);
    pair.write(hello());
    REQUIRE(pair.until_closed());
    CHECK(pair.end.code == Errc::connection_lost);
    CHECK(pair.end.text.find("no sign of life for 150 ms") != std::string::npos);
    CHECK(pair.end.packets.size() == 1);
}

TEST_CASE_TEMPLATE("bad peer: when heartbeats are not waited for, silence after the hello is not noticed", Place, Unix,
                   Tcp)
{
    const SwitchedOff heartbeats("heartbeats");
    RawPair pair(Place::address, hasty);
    pair.write(hello());
    CHECK_FALSE(pair.until_closed(4 * hasty.silence));
}

TEST_CASE_TEMPLATE("bad peer: a packet that trickles is cut off although bytes come", Place, Unix, Tcp)
{
    RawPair pair(Place::address, hasty);
    trickle(pair);
    REQUIRE(pair.end.closed == 1);
    CHECK(pair.end.code == Errc::timeout);
    CHECK(pair.end.text.find("64 KiB/s") != std::string::npos);
    CHECK(pair.end.packets.size() == 1);
}

TEST_CASE_TEMPLATE("bad peer: when progress is not asked for, a packet that trickles holds its connection", Place, Unix,
                   Tcp)
{
    const SwitchedOff progress("progress");
    Timing timing = hasty;
    timing.silence = patient.silence;
    RawPair pair(Place::address, timing);
    trickle(pair);
    CHECK(pair.end.closed == 0);
}

TEST_CASE_TEMPLATE("bad peer: an end inside a packet says where, and delivers nothing of it", Place, Unix, Tcp)
{
    const auto packet = encoded(PacketType::event, std::string(100, 'h'), std::string(50'000, 'b'));
    struct Cut {
        std::size_t bytes;
        const char* text;
    };
    for (const auto& cut : {Cut{0, "peer ended the connection"}, Cut{1, "after 1 of 16 bytes of its prefix"},
                            Cut{15, "15 of 16 bytes of its prefix"}, Cut{16, "0 of 100 bytes of its header"},
                            Cut{66, "50 of 100 bytes of its header"}, Cut{116, "0 of 50000 bytes of its body"},
                            Cut{50'115, "49999 of 50000 bytes of its body"}}) {
        CAPTURE(cut.bytes);
        RawPair pair(Place::address, patient);
        pair.write(hello() + packet.substr(0, cut.bytes));
        pair.raw->close();
        REQUIRE(pair.until_closed());
        CHECK(pair.end.code == Errc::connection_lost);
        CAPTURE(pair.end.text);
        CHECK(pair.end.text.find(cut.text) != std::string::npos);
        CHECK((pair.end.text.find("inside") != std::string::npos) == (cut.bytes > 0));
        CHECK(pair.end.packets.size() == 1);
    }
}

TEST_CASE_TEMPLATE("bad peer: a heartbeat with a header or a body is malformed, from its prefix", Place, Unix, Tcp)
{
    for (const auto& bytes : {prefix(PacketType::ping, 2, 0), prefix(PacketType::ping, 0, 1),
                              prefix(PacketType::pong, 1, 0), prefix(PacketType::pong, 0, 0xffffffffU)}) {
        RawPair pair(Place::address, patient);
        pair.write(hello() + bytes);
        REQUIRE(pair.until_closed());
        CHECK(pair.end.code == Errc::malformed);
    }
}

TEST_CASE_TEMPLATE(
    "bad peer: one that shows life and never reads is slow and stays, until the control packets that wait "
    "for it are too many",
    Place, Unix, Tcp)
{
    Timing timing = hasty;
    if (sanitized || std::is_same_v<Place, Tcp>)
        timing.silence = patient.silence;  // two thousand pings take longer to write and to read there
    timing.control_bytes = 16 * 1024;
    RawPair pair(Place::address, timing);
    pair.write(hello());
    REQUIRE(pair.loop.until([&] { return pair.end.has(1); }));
    bool written = false;
    pair.end.send(PacketType::event, "{}", std::string(16u << 20, 'b'), [&](bool all) { written = all; });
    for (int i = 0; i < 40; ++i) {  // four times as long as a packet may stall on its way in
        REQUIRE(pair.write(encoded(PacketType::ping)));
        pair.loop.run_for(hasty.stall / 10);
    }
    CHECK(pair.end.closed == 0);
    CHECK_FALSE(written);
    for (int i = 0; i < 2000 && pair.end.closed == 0; ++i)
        if (!pair.write(encoded(PacketType::ping)))
            break;
    REQUIRE(pair.until_closed());
    INFO(pair.end.text);
    CHECK(pair.end.code == Errc::too_large);
    CHECK(pair.end.text.find("it does not read") != std::string::npos);
}
