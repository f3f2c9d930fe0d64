// Who may look, by what a request brings.
#include <hive/http/answer.hpp>

#include <doctest/doctest.h>

using hive::http::Pass, hive::http::Request;

TEST_CASE("pass: the token is taken from the header Authorization, with any spelling of the scheme")
{
    const Pass pass("secret", "name-1");
    const auto said = [&](std::string_view header) {
        return pass.in_header({.method = "GET", .path = "/", .host = "x", .authorization = header});
    };
    CHECK(said("Bearer secret"));
    CHECK(said("bearer secret"));
    for (const auto* header : {"", "secret", "Bearer", "Bearer ", "Bearer Secret", "Bearer secret ", "Bearer  secret",
                               "Basic secret", "Bearersecret"})
        CHECK_FALSE_MESSAGE(said(header), header);
    CHECK_FALSE(Pass("", "name-1").in_header({.method = "GET", .path = "/", .host = "x", .authorization = "Bearer "}));
}

TEST_CASE("refusal: a page wants an address as its host, no other page, the token, and GET, in this order")
{
    const Pass pass("secret", "name-1");
    const hive::http::Address bind("127.0.0.1", 80);
    Request request{.method = "POST", .path = "/", .host = "evil.example", .site = "cross-site"};
    const auto code = [&] {
        const auto refused = refusal(request, bind, pass, "No token.");
        return refused ? refused->code : 0;
    };
    CHECK(refusal(request, bind, pass, "")->body == "Open this page by its address.\n");
    request.host = "localhost";
    CHECK(refusal(request, bind, pass, "")->body == "Cross-site access denied.\n");
    request.site = "none";
    CHECK(refusal(request, bind, pass, "No token.")->body == "No token.\n");
    request.authorization = "Bearer secret";  // is for programs
    CHECK(code() == 403);
    request.cookie = "secret";
    CHECK(code() == 405);
    request.method = "GET";
    CHECK(code() == 0);
    request.host.reset();
    CHECK(code() == 400);
}

TEST_CASE("refusal of a command: POST is for the page itself, which brings the cookie, its own Origin and JSON")
{
    const Pass pass("secret", "name-1");
    const hive::http::Address bind("127.0.0.1", 80);
    const Request good{.method = "POST",
                       .path = "/",
                       .host = "127.0.0.1:80",
                       .cookie = "secret",
                       .site = "same-origin",
                       .origin = "http://127.0.0.1:80",
                       .content_type = "application/json"};
    const auto code = [&](auto change) {
        Request request = good;
        change(request);
        const auto refused = refusal_of_command(request, bind, pass, "No token.");
        return refused ? refused->code : 0;
    };
    CHECK(code([](Request&) {}) == 0);
    CHECK(code([](Request& request) { request.site = {}; }) == 0);  // a browser that does not say
    for (const auto* site : {"cross-site", "same-site"})
        CHECK(code([&](Request& request) { request.site = site; }) == 403);
    for (const auto* origin :
         {"", "null", "http://127.0.0.1:81", "http://127.0.0.1", "https://127.0.0.1:80", "http://evil"})
        CHECK_MESSAGE(code([&](Request& request) { request.origin = origin; }) == 403, origin);
    CHECK(code([](Request& request) { request.cookie = {}; }) == 403);
    CHECK(code([](Request& request) { request.cookie = {}, request.token = "secret"; }) == 403);
    CHECK(code([](Request& request) { request.host = "evil.example"; }) == 403);
    for (const auto* type : {"", "text/plain", "application/x-www-form-urlencoded", "multipart/form-data"})
        CHECK_MESSAGE(code([&](Request& request) { request.content_type = type; }) == 415, type);
    for (const auto* method : {"PUT", "DELETE", "HEAD", "OPTIONS"})
        CHECK_MESSAGE(code([&](Request& request) { request.method = method; }) == 405, method);
    CHECK(code([](Request& request) { request.method = "GET", request.origin = {}, request.content_type = {}; }) == 0);
}
