// Allowed camera URLs and addresses, and logins.
#include "address_rule.hpp"
#include "camera_url.hpp"
#include "credentials.hpp"

#include <certificate_file.hpp>
#include <doctest/doctest.h>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>

using namespace axis;
using capture::check_certificate;

namespace {

std::string refusal(const std::string& url)
{
    try {
        parse_camera_url(url);
    } catch (const std::invalid_argument& problem) {
        return problem.what();
    }
    return "";
}

bool allows(const AddressRule& rule, const char* text)
{
    sockaddr_in four{};
    four.sin_family = AF_INET;
    sockaddr_in6 six{};
    six.sin6_family = AF_INET6;
    if (::inet_pton(AF_INET, text, &four.sin_addr) == 1)
        return rule.allows(reinterpret_cast<const sockaddr&>(four));
    REQUIRE(::inet_pton(AF_INET6, text, &six.sin6_addr) == 1);
    return rule.allows(reinterpret_cast<const sockaddr&>(six));
}

/// A file with these bytes and this mode, gone at the end.
class File {
public:
    File(const std::string& text, mode_t mode)
    {
        const int descriptor = ::mkstemp(path.data());
        REQUIRE(descriptor >= 0);
        ::close(descriptor);
        std::ofstream(path) << text;
        ::chmod(path.c_str(), mode);
    }
    ~File() { ::unlink(path.c_str()); }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    std::string path = "/tmp/hive-axis-XXXXXX";
};

}  // namespace

TEST_CASE("url: scheme, host and port")
{
    CHECK(parse_camera_url("http://192.0.2.10").text() == "http://192.0.2.10");
    CHECK(parse_camera_url("https://door.example:8443/") == CameraUrl{"https", "door.example", 8443});
    CHECK(parse_camera_url("http://[2001:db8::1]:80").host == "[2001:db8::1]");
    CHECK(parse_camera_url("https://x").encrypted());
}

TEST_CASE("url: an invalid camera URL is refused with a reason that omits its password")
{
    for (const char* url :
         {"", "192.0.2.10", "ftp://x", "file:///etc/passwd", "http://", "http://:80", "http://x:0", "http://x:99999",
          "http://x:", "http://x:8a", "http://x/axis-cgi", "http://x?y", "http://x#y", "http://a b", "http://[::1",
          "http://[x]", "http://x\ny", "HTTP://x", "gopher://x"})
        CHECK_MESSAGE(refusal(url).starts_with("url: "), url);
    const std::string secret = refusal("http://root:se/cret@192.0.2.10");
    CHECK(secret.find("credentials") != std::string::npos);
    CHECK(secret.find("cret") == std::string::npos);
}

TEST_CASE("url: a text for the log shows no password, no query and no control character")
{
    CHECK(masked("http://root:pass@x/y?z=1") == "http://***@x/y");
    CHECK(masked("http://x/@y") == "http://x/@y");
    CHECK(masked("a\nb\x1B") == "a.b.");
    CHECK(masked(std::string(1000, 'x')).size() < 250);
}

TEST_CASE("addresses: this machine, its neighbours and groups are refused, in every notation, unless they are named")
{
    const AddressRule usual;
    for (const char* text :
         {"127.0.0.1", "127.9.9.9", "0.0.0.0", "0.1.2.3", "169.254.169.254", "224.0.0.1", "255.255.255.255",
          "::", "::1", "::7f00:1", "fe80::1", "febf::1", "ff02::1", "::ffff:127.0.0.1", "::ffff:169.254.169.254"})
        CHECK_MESSAGE(!allows(usual, text), text);
    for (const char* text :
         {"192.0.2.10", "10.0.0.1", "172.16.0.1", "192.168.0.90", "2001:db8::1", "fd00::1", "::ffff:192.0.2.10"})
        CHECK_MESSAGE(allows(usual, text), text);
    const AddressRule named("127.0.0.1,fe80::1");
    CHECK(allows(named, "127.0.0.1"));
    CHECK(allows(named, "::ffff:127.0.0.1"));
    CHECK(allows(named, "fe80::1"));
    CHECK_FALSE(allows(named, "127.0.0.2"));
    CHECK_THROWS_AS(AddressRule("localhost"), std::invalid_argument);
    CHECK_THROWS_AS(AddressRule("127.0.0.1,,"), std::invalid_argument);
}

TEST_CASE("addresses: an invalid address is refused")
{
    sockaddr unknown{};
    unknown.sa_family = AF_UNIX;
    CHECK_FALSE(AddressRule().allows(unknown));
}

TEST_CASE("certificate: a missing file, or one without a certificate, is refused by name")
{
    CHECK_NOTHROW(check_certificate(""));
    CHECK_NOTHROW(check_certificate(
        File("of the door\n-----BEGIN CERTIFICATE-----\nMIIB\n-----END CERTIFICATE-----\n", 0644).path));
    CHECK_THROWS_WITH_AS(check_certificate("/nowhere/at/all"), "certificate: no such file: /nowhere/at/all",
                         std::runtime_error);
    CHECK_THROWS_WITH_AS(check_certificate("/tmp"), doctest::Contains("no such file: /tmp"), std::runtime_error);
    const File key("-----BEGIN PRIVATE KEY-----\n", 0600), empty("", 0600);
    for (const auto* file : {&key, &empty})
        CHECK_THROWS_WITH_AS(check_certificate(file->path),
                             doctest::Contains((file->path + " contains no certificate").c_str()), std::runtime_error);
}

TEST_CASE("credentials: from a file that its owner alone can read")
{
    CHECK(read_credentials(File("root:pa:ss\r\nmore", 0600).path) == Credentials{"root", "pa:ss"});
    CHECK(read_credentials(File("root:", 0400).path) == Credentials{"root", ""});
    CHECK(read_credentials(File("root:pass\r\nhttp://192.0.2.10/\r\n", 0600).path)
          == Credentials{"root", "pass", "http://192.0.2.10"});
    CHECK_THROWS_WITH_AS(read_credentials(File("root:pass\nhttp://a b", 0600).path), doctest::Contains("url: "),
                         std::invalid_argument);
    for (const mode_t mode : {0640, 0604, 0644, 0660, 0601})
        CHECK_THROWS_WITH_AS(read_credentials(File("root:pass", mode).path), doctest::Contains("chmod 600"),
                             std::runtime_error);
    CHECK_THROWS_WITH_AS(read_credentials(File("rootpass", 0600).path), doctest::Contains("user:password"),
                         std::runtime_error);
    CHECK_THROWS_AS(read_credentials(File("", 0600).path), std::runtime_error);
    CHECK_THROWS_WITH_AS(read_credentials("/nowhere/at/all"), doctest::Contains("/nowhere/at/all"), std::runtime_error);
    CHECK_THROWS_WITH_AS(read_credentials("/tmp"), doctest::Contains("not a file"), std::runtime_error);
}

TEST_CASE("credentials: a file that is written again with the same has another time; none has always the same")
{
    const File file("root:pass", 0600);
    const auto before = written_at(file.path);
    std::filesystem::last_write_time(file.path, before + std::chrono::seconds(1));
    CHECK(written_at(file.path) > before);
    CHECK(written_at("") == written_at("/nowhere/at/all"));
}

TEST_CASE("credentials: without a file from the environment, or none")
{
    ::unsetenv(user_variable);
    CHECK_FALSE(read_credentials(""));
    ::setenv(user_variable, "viewer", 1);
    ::setenv(password_variable, "secret", 1);
    CHECK(read_credentials("") == Credentials{"viewer", "secret"});
    ::setenv(password_variable, "", 1);
    CHECK_THROWS_WITH_AS(read_credentials(""), doctest::Contains("HIVE_AXIS_PASSWORD is missing"), std::runtime_error);
    ::unsetenv(password_variable);
    CHECK_THROWS_WITH_AS(read_credentials(""), doctest::Contains("HIVE_AXIS_PASSWORD is missing"), std::runtime_error);
    ::unsetenv(user_variable);
    ::setenv(password_variable, "secret", 1);
    CHECK_THROWS_WITH_AS(read_credentials(""), doctest::Contains("HIVE_AXIS_USER is missing"), std::runtime_error);
    ::unsetenv(password_variable);
}
