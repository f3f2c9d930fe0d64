// Addresses as text.
#include <hive/transport/transport.hpp>

#include <doctest/doctest.h>

using namespace hive::transport;
using namespace std::chrono_literals;

TEST_CASE("address: what is written is read again")
{
    for (const char* text :
         {"unix:/run/hive/face", "tcp://127.0.0.1:5000", "tcp://[::1]:0", "tcp://camera-1.lab:65535"})
        CHECK(to_text(parse_address(text)) == text);
    CHECK(parse_address("tcp://[::1]:70") == Address{Address::Scheme::tcp, "::1", 70});
    CHECK(parse_address("unix:/a") == Address{Address::Scheme::unix_socket, "/a", 0});
}

TEST_CASE("address: what is none is refused with the text")
{
    for (const std::string text :
         {"", "unix:", "tcp://", "tcp://:5", "tcp://a", "tcp://a:", "tcp://a:-1", "tcp://a:65536", "tcp://a:5x",
          "tcp://::1:5", "tcp://[]:5", "tcp://user@a:5", "tcp://a b:5", "tcp:a:5", "http://a:5", "/tmp/a"}) {
        CAPTURE(text);
        try {
            parse_address(text);
            FAIL("accepted");
        } catch (const hive::Error& error) {
            CHECK(error.code() == hive::Errc::invalid_argument);
            CHECK(std::string(error.what()).starts_with("invalid address \"" + text + "\": "));
            CHECK(error.advice().starts_with("use "));
        }
    }
    CHECK_THROWS_AS(parse_address(std::string("unix:/a\0b", 9)), hive::Error);
}
