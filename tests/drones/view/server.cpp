// The HTTP server of the view drone against well-behaved, slow and rude browsers.
#include "stage.hpp"

#include <doctest/doctest.h>

#include <stdexcept>

using hive::test::eventually, hive::test::Milliseconds;
using http::Client, http::get;
using stage::next_width, stage::notice_width, stage::Stage;

TEST_CASE("view server: page, snapshot and status over HTTP; other pages may not use them")
{
    Stage stage;
    CHECK(get(stage.port(), "/picture.jpg").code == 503);
    stage.put(50);
    const auto page = get(stage.port(), "/?some=query");
    CHECK(page.code == 200);
    CHECK(page.body.starts_with("<!DOCTYPE html>"));
    for (const char* header : {"Content-Security-Policy: default-src 'self'", "X-Content-Type-Options: nosniff",
                               "Cross-Origin-Resource-Policy: same-origin"})
        CHECK(page.head.find(header) != std::string::npos);
    CHECK(get(stage.port(), "/picture.jpg").image().cols == 50);
    CHECK(get(stage.port(), "/status.json").json().at("number") == 1);
}

TEST_CASE("view server: a stream sends each image to a fast reader, and all can be decoded")
{
    Stage stage;
    Client client(stage.port());
    client.ask("/stream.mjpg");
    CHECK(next_width(client) == notice_width);
    for (int width = 40; width < 60; ++width) {
        stage.put(width);
        REQUIRE(next_width(client) == width);
    }
}

TEST_CASE("view server: nothing is decoded without viewers, and each image once for all of them")
{
    Stage stage;
    for (int width = 40; width < 60; ++width)
        stage.put(width);
    CHECK(get(stage.port(), "/status.json").json().at("number") == 20);
    CHECK(stage.decoded == 0);
    Client one(stage.port()), two(stage.port());
    for (auto* client : {&one, &two})
        client->ask("/stream.mjpg");
    for (int width = 59; width < 80; ++width) {
        if (width > 59)
            stage.put(width);
        REQUIRE(next_width(one) == width);
        REQUIRE(next_width(two) == width);
        CHECK(get(stage.port(), "/picture.jpg").image().cols == width);
    }
    CHECK(stage.decoded == 21);
}

TEST_CASE(
    "view server: a browser that does not read costs the others nothing, and finds the newest when it reads again")
{
    Stage stage;
    Client reading(stage.port()), stopped(stage.port(), 16 * 1024);
    for (auto* client : {&reading, &stopped})
        client->ask("/stream.mjpg");
    REQUIRE(next_width(reading) == notice_width);
    for (int width = 700; width < 720; ++width) {
        stage.put(width, 700);  // more than all buffers on the way hold
        REQUIRE(next_width(reading) == width);
    }
    CHECK(stage.decoded == 20);
    int seen = 0;
    for (int width = 0; width != 719; ++seen)
        REQUIRE((width = next_width(stopped)) > 0);
    CHECK(seen <= 4);  // the notice, what was on its way, the newest
}

TEST_CASE("view server: one that stops reading for long is forgotten, and so is one that has gone")
{
    Stage stage({.stalled = std::chrono::seconds(3), .repeat = Milliseconds(100)});
    {
        Client stopped(stage.port(), 16 * 1024);
        stopped.ask("/stream.mjpg");
        stage.put(700, 700);
        REQUIRE(eventually([&] { return stage.browsers() == 1; }, Milliseconds(3000)));
        CHECK(eventually([&] { return stage.browsers() == 0; }, Milliseconds(10'000)));
    }
    {
        Client leaving(stage.port());
        leaving.ask("/stream.mjpg");
        REQUIRE(next_width(leaving) == 700);
        REQUIRE(stage.browsers() == 1);
    }
    CHECK(eventually([&] { return stage.browsers() == 0; }, Milliseconds(3000)));
}

TEST_CASE("view server: no more streams than are allowed, and the page is still there")
{
    Stage stage({.streams = 2});
    Client one(stage.port()), two(stage.port());
    for (auto* client : {&one, &two}) {
        client->ask("/stream.mjpg");
        REQUIRE(next_width(*client) == notice_width);
    }
    CHECK(get(stage.port(), "/stream.mjpg").code == 503);
    CHECK(get(stage.port(), "/").code == 200);
}

TEST_CASE("view server: bad requests get an error and affect no other client")
{
    Stage stage;
    Client reading(stage.port());
    reading.ask("/stream.mjpg");
    REQUIRE(next_width(reading) == notice_width);
    const std::string host = "Host: 127.0.0.1\r\n" + http::cookie(stage.port());
    const std::vector<std::pair<std::string, int>> bad{
        {"POST / HTTP/1.1\r\n" + host + "Content-Length: 1000000\r\n\r\nabc", 405},
        {"HEAD / HTTP/1.1\r\n" + host + "\r\n", 405},
        {"DELETE /picture.jpg HTTP/1.1\r\n" + host + "\r\n", 405},
        {"GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n", 403},
        {"GET /status.json HTTP/1.1\r\nHost: evil.example:80\r\n\r\n", 403},
        {"GET / HTTP/1.1\r\n\r\n", 400},
        {"GET / HTTP/1.0\r\n\r\n", 400},
        {"GET /../../etc/passwd HTTP/1.1\r\n" + host + "\r\n", 404},
        {"GET /%2e%2e/etc/passwd HTTP/1.1\r\n" + host + "\r\n", 404},
    };
    int width = 40;
    for (const auto& [request, code] : bad) {
        CAPTURE(request);
        Client client(stage.port());
        client.send(request);
        CHECK(client.reply().code == code);
        stage.put(++width);
        CHECK(next_width(reading) == width);
    }
}

TEST_CASE("view server: a request that is too long, invalid or never complete is closed")
{
    Stage stage({.asking = Milliseconds(300)});
    Client reading(stage.port());
    reading.ask("/stream.mjpg");
    REQUIRE(next_width(reading) == notice_width);
    for (const std::string& request :
         {"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: " + std::string(100'000, 'x') + "\r\n\r\n",
          "GET /" + std::string(100'000, 'x') + " HTTP/1.1\r\n\r\n", std::string(100'000, '\xFF'),
          std::string("\r\n\r\n\r\n"), std::string("GET / HT"), std::string()}) {
        CAPTURE(request.size());
        Client client(stage.port());
        client.send(request);
        CHECK(client.closed_within(Milliseconds(60'000)));
    }
    Client slow(stage.port());  // never idle, never complete
    CHECK(eventually([&] { return !slow.send("x") || slow.closed_within(Milliseconds(1)); }, Milliseconds(5000)));
    stage.put(77);
    CHECK(eventually([&] { return next_width(reading) == 77; },
                     Milliseconds(5000)));  // the last one may have been repeated meanwhile
}

TEST_CASE("view server: idle unauthenticated clients take no capacity from viewers")
{
    Stage stage({.connections = 4, .strangers = 4, .asking = Milliseconds(60'000)});
    Client reading(stage.port());
    reading.ask("/stream.mjpg");
    REQUIRE(next_width(reading) == notice_width);
    std::vector<std::unique_ptr<Client>> idle;
    for (int i = 0; i < 40; ++i) {
        idle.push_back(std::make_unique<Client>(stage.port()));
        idle.push_back(std::make_unique<Client>(stage.port()));
        idle.back()->send("GET / HT");
    }
    CHECK(eventually([&] { return get(stage.port(), "/").code == 200; }, Milliseconds(5000)));
    stage.put(77);
    CHECK(eventually([&] { return next_width(reading) == 77; }, Milliseconds(5000)));  // a repeated one may come before
}

TEST_CASE("view server: connections beyond the limit get an error, until one closes")
{
    Stage stage({.connections = 2, .streams = 2});
    Client one(stage.port());
    {
        Client two(stage.port());
        for (auto* client : {&one, &two}) {
            client->ask("/stream.mjpg");
            REQUIRE(next_width(*client) == notice_width);
        }
        CHECK(get(stage.port(), "/").code == 503);
    }
    stage.put(77);  // which detects that the client is gone
    CHECK(eventually([&] { return get(stage.port(), "/").code == 200; }, Milliseconds(5000)));
}

TEST_CASE("view server: no access without the token; with it in the address a cookie is set")
{
    Stage stage;
    stage.put(50);
    const auto asked = [&](const std::string& path, const std::string& headers) {
        Client client(stage.port());
        client.send("GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\n" + headers + "\r\n");
        return client.reply();
    };
    const std::string cookie = http::cookie(stage.port());
    for (const std::string path : {"/", "/view.js", "/picture.jpg", "/stream.mjpg", "/status.json", "/nothing"}) {
        CAPTURE(path);
        CHECK(asked(path, "").code == 403);
        CHECK(asked(path, http::cookie(stage.port(), "0123456789abcdee")).code == 403);
        CHECK(asked(path + "?token=", "").code == 403);
        CHECK(asked(path + "?token=guess", "").code == 403);
        for (const char* site : {"cross-site", "same-site"})  // another port of the same address is the same site
            CHECK(asked(path, cookie + "Sec-Fetch-Site: " + site + "\r\n").code == 403);
    }
    const auto first = asked("/?token=" + http::token, "Sec-Fetch-Site: none\r\n");
    CHECK(first.code == 303);
    CHECK(first.head.find("Location: /\r\n") != std::string::npos);
    CHECK(first.head.find("Set-Cookie: hive-view-" + std::to_string(stage.port()) + "=" + http::token
                          + "; Path=/; HttpOnly; SameSite=Strict")
          != std::string::npos);
    CHECK(asked("/", cookie + "Sec-Fetch-Site: none\r\n").code == 200);
    CHECK(asked("/picture.jpg", cookie + "Sec-Fetch-Site: same-origin\r\n").image().cols == 50);
    CHECK(asked("/picture.jpg?token=" + http::token, "").image().cols == 50);  // for curl
}

TEST_CASE("view server: stops with browsers connected, and frees its port")
{
    auto stage = std::make_unique<Stage>();
    const int port = stage->port();
    CHECK_THROWS_WITH_AS(Stage({.port = port}), doctest::Contains("in use"), std::runtime_error);
    Client waiting(port), stopped(port, 16 * 1024), silent(port);
    for (auto* client : {&waiting, &stopped})
        client->ask("/stream.mjpg");
    stage->put(700, 700);
    REQUIRE(eventually([&] { return next_width(waiting) == 700; }, Milliseconds(3000)));
    stage.reset();
    for (auto* client : {&waiting, &stopped, &silent})
        CHECK(client->closed_within(Milliseconds(60'000)));
    const Stage next({.port = port});
    CHECK(get(next.port(), "/").code == 200);
}
