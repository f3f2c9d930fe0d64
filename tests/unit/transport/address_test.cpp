// Addresses as text, and the pauses between attempts.
#include <hive/transport/transport.hpp>

#include <doctest/doctest.h>

using namespace hive::transport;
using namespace std::chrono_literals;

TEST_CASE("address: what is written is read again")
{
    for (const char* text :
         {"unix:/run/hive/face", "tcp://127.0.0.1:5000", "tcp://[::1]:0", "tcp://camera-1.lab:65535", "in-process:a"})
        CHECK(to_text(parse_address(text)) == text);
    CHECK(parse_address("tcp://[::1]:70") == Address{Address::Scheme::tcp, "::1", 70});
    CHECK(parse_address("unix:/a") == Address{Address::Scheme::unix_socket, "/a", 0});
}

TEST_CASE("address: what is none is refused with the text")
{
    for (const std::string text : {"", "unix:", "in-process:", "tcp://", "tcp://:5", "tcp://a",
                                   "tcp://a:", "tcp://a:-1", "tcp://a:65536", "tcp://a:5x", "tcp://::1:5", "tcp://[]:5",
                                   "tcp://user@a:5", "tcp://a b:5", "tcp:a:5", "http://a:5", "/tmp/a"}) {
        CAPTURE(text);
        try {
            parse_address(text);
            FAIL("accepted");
        } catch (const hive::Error& error) {
            CHECK(error.code() == hive::Errc::invalid_argument);
            CHECK(std::string(error.what()).find(text) != std::string::npos);
        }
    }
    CHECK_THROWS_AS(parse_address(std::string("unix:/a\0b", 9)), hive::Error);
}

TEST_CASE("backoff: pauses double up to the most, each within half of itself, the same for the same seed")
{
    Backoff one(100ms, 5s, 7);
    Backoff same(100ms, 5s, 7);
    Backoff other(100ms, 5s, 8);
    bool differs = false;
    for (int i = 0; i < 100; ++i) {
        const auto middle = std::min(5000.0, 100.0 * (1LL << std::min(i, 30)));
        const auto pause = one.next();
        CHECK(pause.count() >= middle / 2 - 1);
        CHECK(pause.count() <= middle * 3 / 2);
        CHECK(pause == same.next());
        differs = differs || pause != other.next();
    }
    CHECK(differs);
    one.reset();
    CHECK(one.next() <= 150ms);
    CHECK(Backoff(100ms, 5s, 0).next() >= 50ms);
}
