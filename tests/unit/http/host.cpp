// Who may ask, by the Host header.
#include <hive/http/host.hpp>

#include <doctest/doctest.h>

#include <stdexcept>

using hive::http::Address, hive::http::host_fits;

TEST_CASE("host: at a loopback address, that address and localhost are answered, with any port or none")
{
    const Address bind("127.0.0.1", 8080);
    for (const char* host : {"localhost", "LocalHost:8080", "127.0.0.1", "127.0.0.1:8080", "127.0.0.1:1", "[::1]",
                             "[::1]:8080", "127.1.2.3"})
        CHECK_MESSAGE(host_fits(host, bind), host);
}

TEST_CASE("host: names of others are refused, whatever they look like; so is what is no host")
{
    for (const char* bind : {"127.0.0.1", "0.0.0.0", "::", "192.168.1.5"})
        for (const char* host :
             {"evil.example", "evil.example:8080", "localhost.evil.example", "127.0.0.1.evil.example",
              "localhost@evil.example", "", "127.0.0.1:8080:1", "127.0.0.1:80a", "[::1", "[::1]x", "::1", "127.1",
              "0x7f000001", "2130706433", "localhost.", " localhost", ":80"})
            CHECK_FALSE_MESSAGE(host_fits(host, Address(bind, 8080)), bind, " ", host);
}

TEST_CASE("host: an address of another machine is answered only by who listens there, or everywhere")
{
    CHECK(host_fits("192.168.1.5:8080", Address("192.168.1.5", 8080)));
    CHECK(host_fits("192.168.1.5:8080", Address("0.0.0.0", 8080)));
    CHECK(host_fits("[fe80::1]:8080", Address("::", 8080)));
    CHECK_FALSE(host_fits("192.168.1.6:8080", Address("192.168.1.5", 8080)));
    CHECK_FALSE(host_fits("192.168.1.5:8080", Address("127.0.0.1", 8080)));
    CHECK_FALSE(host_fits("[fe80::1]", Address("::1", 8080)));
}

TEST_CASE("address: what is not one is refused with the text")
{
    for (const char* text : {"", "localhost", "127.0.0", "example.com", "::1::", "127.0.0.1:80"})
        CHECK_THROWS_WITH_AS(Address(text, 1), doctest::Contains(text), std::runtime_error);
    CHECK(Address("::1", 1).loopback());
    CHECK(Address("0.0.0.0", 1).any());
    CHECK_FALSE(Address("10.0.0.1", 1).loopback());
}

TEST_CASE("address: the url is written as a browser wants it")
{
    CHECK(hive::http::url_of("127.0.0.1", 8080) == "http://127.0.0.1:8080/");
    CHECK(hive::http::url_of("::1", 8080) == "http://[::1]:8080/");
}
