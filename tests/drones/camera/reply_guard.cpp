// The judge of replies alone, line by line.
#include "reply_guard.hpp"

#include <doctest/doctest.h>

#include <initializer_list>
#include <string>

using camera::ReplyGuard;
using camera::ReplyRules;

namespace {

ReplyRules with_login()
{
    ReplyRules rules;
    rules.rtsp = true;
    rules.has_login = true;
    return rules;
}

std::string judged(std::initializer_list<const char*> lines, ReplyRules rules = with_login())
{
    ReplyGuard guard(rules);
    for (const char* line : lines)
        guard.take(line);
    return guard.refusal();
}

}  // namespace

TEST_CASE("reply guard: what cameras say is accepted")
{
    CHECK(judged({"RTSP/1.0 200 OK", "Content-Length: 1000", "Location: rtsp://x/", ""}).empty());
    CHECK(judged({"RTSP/1.0 401 No", "WWW-Authenticate: Basic a", "WWW-Authenticate: Digest b", ""}).empty());
    CHECK(judged({"", "RTSP/1.0 200 OK", "", ""}).empty());
    CHECK(judged({"RTSP/1.0 200 OK", "Content-Length: 65536", ""}).empty());
    ReplyRules http = with_login();
    http.rtsp = false;
    CHECK(judged({"HTTP/1.1 200 OK", "Content-Length: 5000000000", ""}, http).empty());
    http.has_login = false;
    CHECK(judged({"HTTP/1.1 401 No", "WWW-Authenticate: Basic a", ""}, http).empty());
}

TEST_CASE("reply guard: an offer of digest counts only as FFmpeg reads it, one of basic in any form")
{
    for (const char* basic : {"WWW-Authenticate:Basic", "www-AUTHENTICATE:\v\f\t basic x", "WWW-Authenticate: BASIC x"})
        for (const char* other :
             {"x: y", "WWW-Authenticate:\vDigest x", "WWW-Authenticate: Digest", "WWW-Authenticate : Digest x"})
            CHECK(judged({"RTSP/1.0 401 No", other, basic, ""}).starts_with("it accepts only an unencrypted password"));
    ReplyRules allowed = with_login();
    allowed.basic_allowed = true;
    CHECK(judged({"RTSP/1.0 401 No", "WWW-Authenticate: Basic a", ""}, allowed).empty());
}

TEST_CASE("reply guard: a length that would become another one in an int is refused")
{
    for (const char* length : {"65537", "2147483648", "4294967297", "-2147483649", "-1", "99999999999999999999"})
        CHECK(judged({"RTSP/1.0 200 OK", ("content-LENGTH: " + std::string(length)).c_str()})
                  .starts_with("it announces"));
}

TEST_CASE("reply guard: a head has an end, a place elsewhere is shown without its secrets, and questions are counted")
{
    ReplyGuard endless(with_login());
    for (int i = 0; i < 100; ++i)
        endless.take("X: " + std::string(1000, 'x'));
    CHECK(endless.refusal() == "the head of its reply is larger than 64 KiB");
    CHECK(judged({"RTSP/1.0 301 Moved", "Location: rtsp://a:b@x/y?z", ""})
          == "it redirects to rtsp://***@x/y (301), which is not followed");
    ReplyGuard asking(with_login());
    for (int i = 0; i < 9; ++i)
        for (const char* line : {"RTSP/1.0 401 No", "WWW-Authenticate: Digest x", ""})
            asking.take(line);
    CHECK(asking.refusal() == "it repeats its request for a login");
}
