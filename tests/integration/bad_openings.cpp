// What is not the protocol, or not all of it: closed, soon, without an answer, and at no cost to others.
#include "prey.hpp"

#include <doctest/doctest.h>

using namespace hostile;

namespace {

struct Opening {
    const char* what;
    std::string bytes;
};

/// Closed at once, because the bytes are wrong.
std::vector<Opening> wrong_openings()
{
    const std::string hello = raw::hello_packet();
    std::string zeros(16, '\0');
    return {
        {"HTTP GET", "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"},
        {"HTTP POST with a packet as its body", "POST / HTTP/1.1\r\nContent-Length: 100\r\n\r\n" + hello},
        {"HTTP/2", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"},
        {"TLS hello", std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11) + std::string(500, 'r')},
        {"SSH", "SSH-2.0-OpenSSH_9.2p1 Debian-2\r\n"},
        {"Redis", "*1\r\n$4\r\nPING\r\n......"},
        {"SMTP", "EHLO localhost\r\n........"},
        {"zeros", zeros},
        {"ones", std::string(16, '\xFF')},
        {"the magic backwards", raw::prefix(1, 0, 0, 0, "EVIH")},
        {"the magic in lower case", raw::prefix(1, 0, 0, 0, "hive")},
        {"version 0", raw::prefix(1, 0, 10, 0, "HIVE", 0)},
        {"version 2", raw::prefix(1, 0, 10, 0, "HIVE", 2)},
        {"version 255", raw::prefix(1, 0, 10, 0, "HIVE", 255)},
        {"type 0", raw::packet(0, 0, "{}")},
        {"type 255", raw::packet(255, 0, "{}")},
        {"describe before hello", raw::packet(raw::describe, 0, R"({"id":1})")},
        {"ping before hello", raw::packet(raw::ping, 0, "") + raw::packet(raw::describe, 0, R"({"id":1})")},
        {"hello without a header", raw::packet(raw::hello, 0, "")},
        {"hello that is an array", raw::packet(raw::hello, 0, "[]")},
        {"hello without a name", raw::packet(raw::hello, 0, R"({"kind":"k","epoch":1})")},
        {"hello with a bad name", raw::packet(raw::hello, 0, R"({"name":"../x","kind":"k","epoch":1})")},
        {"hello with a negative epoch", raw::packet(raw::hello, 0, R"({"name":"x","kind":"k","epoch":-1})")},
        {"hello with a body", raw::prefix(raw::hello, 0, 2, 1) + "{}x"},
        {"hello over 4 KiB", raw::prefix(raw::hello, 0, 4081, 0)},
        {"hello of 4 GiB", raw::prefix(raw::hello, 0, 0xFFFFFFFF, 0)},
        {"hello with a body of 4 GiB", raw::prefix(raw::hello, 0, 2, 0xFFFFFFFF)},
        {"both of 4 GiB", raw::prefix(raw::hello, 0, 0xFFFFFFFF, 0xFFFFFFFF)},
        {"header over the limit after hello", hello + raw::prefix(raw::describe, 0, 65537, 0)},
        {"header of 4 GiB after hello", hello + raw::prefix(raw::describe, 0, 0xFFFFFFFF, 0)},
        {"body over the limit after hello", hello + raw::prefix(raw::put, 0, 2, 67108865)},
        {"body of 4 GiB after hello", hello + raw::prefix(raw::put, 0, 2, 0xFFFFFFFF)},
        {"a second hello", hello + hello},
        {"garbage after hello", hello + std::string(64, 'g')},
    };
}

/// Nothing is wrong with these yet: closed when their time is over.
std::vector<Opening> unfinished_openings()
{
    const std::string hello = raw::hello_packet();
    return {{"silence", ""},
            {"one byte", "H"},
            {"half a prefix", hello.substr(0, 8)},
            {"a prefix alone", hello.substr(0, 16)},
            {"half a hello", hello.substr(0, 40)},
            {"all but a byte", hello.substr(0, hello.size() - 1)}};
}

}  // namespace

TEST_CASE("hostile client: whatever opens a connection wrongly is closed at once and costs the drone nothing")
{
    const Prey prey = Prey::camera();
    const Witness witness(prey);
    REQUIRE(hive::test::eventually([&] { return witness.received() > 3; },
                                   within(5000)));  // the first image takes memory for good
    REQUIRE(prey.well());
    const auto memory = hive::test::resident_bytes(prey.pid());
    const auto descriptors = hive::test::open_descriptors(prey.pid());
    {
        auto newer = prey.dial();  // first, because the log has ten lines a second for one peer
        newer.send(raw::prefix(raw::hello, 0, 2, 0, "HIVE", 2));
        CHECK(newer.closed_within(within(500)));
    }
    for (const auto& opening : wrong_openings()) {
        CAPTURE(opening.what);
        auto peer = prey.dial();
        peer.send(opening.bytes);
        CHECK(peer.closed_within(within(500)));
    }
    CHECK(prey.well());
    CHECK(
        hive::test::eventually([&] { return hive::test::open_descriptors(prey.pid()) <= descriptors; }, within(2000)));
    if (!hive::test::sanitized())
        CHECK(hive::test::resident_bytes(prey.pid()) < memory + (2u << 20));
    CHECK(witness.lost() == 0);
    CHECK_FALSE(witness.cut_off());
    CHECK(prey.log().find("version 2") != std::string::npos);
}

TEST_CASE("hostile client: one that says nothing, or not all of its hello, is closed after two seconds")
{
    const Prey prey = Prey::face();
    std::vector<raw::Peer> peers;
    const auto begin = Clock::now();
    for (const auto& opening : unfinished_openings()) {
        peers.push_back(prey.dial());
        REQUIRE(peers.back().send(opening.bytes));
    }
    std::size_t closed = 0;
    while (closed < peers.size() && Clock::now() - begin < within(3000))
        for (auto& peer : peers)
            if (!peer.ended() && peer.closed_within(Milliseconds(20))) {
                CHECK(Clock::now() - begin > Milliseconds(1500));
                ++closed;
            }
    CHECK(closed == peers.size());
    CHECK(prey.well());
}

TEST_CASE(
    "hostile client: one that sends its hello byte by byte is served if it ends in time, and closed if it does not")
{
    const Prey prey = Prey::face();
    const std::string hello = raw::hello_packet();
    auto quick = prey.dial(), slow = prey.dial();
    for (const char byte : hello)
        REQUIRE(quick.send(std::string(1, byte)));
    CHECK(raw::error_of(quick.ask(raw::status)) == "");
    const auto begin = Clock::now();
    for (std::size_t i = 0; i < hello.size() && slow.send(hello.substr(i, 1)) && !slow.ended(); ++i)
        slow.closed_within(Milliseconds(50));
    CHECK(slow.closed_within(within(1000)));
    CHECK(Clock::now() - begin < Milliseconds(8000));
}

TEST_CASE("hostile client: a packet cut anywhere by the end of the stream is never acted upon")
{
    const Prey prey = Prey::face();
    const std::string set = raw::packet(raw::set, 0, R"({"id":1,"parameters":{"min_size":33}})");
    for (std::size_t size = 0; size < set.size(); ++size) {
        auto peer = prey.dial();
        REQUIRE(peer.send(raw::hello_packet() + set.substr(0, size)));
    }
    CHECK(hive::test::eventually([&] { return prey.well(); }, within(1000)));
    auto peer = prey.meet();
    CHECK(peer.ask(raw::get, {{"names", {"min_size"}}}).at("result").at("parameters").at("min_size") == 24);
    REQUIRE(peer.send(set));  // the twin: whole, it is
    CHECK(hive::test::eventually(
        [&] {
            return peer.ask(raw::get, {{"names", {"min_size"}}}).at("result").at("parameters").at("min_size") == 33;
        },
        within(1000)));
}

TEST_CASE("hostile client: a body that stops, or trickles, is cut off though the peer answers pings; the memory "
          "follows the bytes that came")
{
    const Prey prey = Prey::face();
    REQUIRE(prey.well());
    const auto memory = hive::test::resident_bytes(prey.pid());
    const std::string header = R"({"id":1,"input":"image","type":"image/jpeg"})";
    std::vector<raw::Peer> peers;
    for (int i = 0; i < 8; ++i) {
        peers.push_back(prey.meet("staller-" + std::to_string(i)));
        REQUIRE(peers.back().send(raw::prefix(raw::put, 0, static_cast<std::uint32_t>(header.size()), 64u << 20)
                                  + header + std::string(1000, 'b')));
    }
    if (!hive::test::sanitized())
        CHECK(hive::test::resident_bytes(prey.pid()) < memory + 8 * (1u << 20) + (4u << 20));
    const auto begin = Clock::now();
    std::size_t alive = peers.size();
    while (alive > 0 && Clock::now() - begin < within(9000)) {
        alive = 0;
        for (auto& peer : peers)
            if (!peer.ended()) {
                peer.send("b");
                peer.closed_within(Milliseconds(5));
                alive += !peer.ended();
            }
    }
    CHECK(alive == 0);
    CHECK(Clock::now() - begin > Milliseconds(3000));
    CHECK(prey.well());
}
