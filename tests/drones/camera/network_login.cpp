// What network cameras learn of a login.
#include "network_stage.hpp"

#include <doctest/doctest.h>

using namespace network;

TEST_CASE("network camera: no password is sent unencrypted unless that is allowed")
{
    const Camera http([](Client& client, const std::string&) {
        client.send("HTTP/1.1 401 No\r\nWWW-Authenticate:\v Basic realm=\"x\"\r\nContent-Length: 0\r\n\r\n");
        return false;
    });
    const Camera rtsp([](Client& client, const std::string& request) {
        return client.send(hostile::rtsp(request, "401 No", "WWW-Authenticate: Basic realm=\"x\"\r\n"));
    });
    for (const auto* camera : {&http, &rtsp}) {
        const std::string url = camera->url(camera == &http ? "http" : "rtsp");
        CAPTURE(url);
        auto settings = settings_of(url);
        settings.login = {"root", "hush-hush", {}};
        CHECK(says(told_by(settings), "it accepts only an unencrypted password"));
        CHECK_FALSE(says(camera->asked(), "Authorization"));
        settings.basic_over_http = true;
        CHECK(says(told_by(settings), "the camera refuses this login"));
        CHECK(says(camera->asked(), "Authorization: Basic"));
    }
}

TEST_CASE("network camera: a digest is sent where both are offered, and not along a redirection")
{
    const Camera elsewhere(always(""));
    for (const std::string scheme : {"http", "rtsp"}) {
        CAPTURE(scheme);
        const auto protocol = scheme == "http" ? std::string("HTTP/1.1 ") : "RTSP/1.0 ";
        const Camera camera([&](Client& client, const std::string& request) {
            const bool login = says(request, "Authorization:");
            client.send(protocol + (login ? "302 Found\r\n" : "401 No\r\n") + hostile::sequence(request)
                        + (login ? "Location: " + elsewhere.url(scheme) + "\r\n"
                                 : std::string("WWW-Authenticate: Basic realm=\"x\"\r\nWWW-Authenticate: Digest "
                                               "realm=\"x\", nonce=\"1\"\r\n"))
                        + "Content-Length: 0\r\n\r\n");
            return true;
        });
        auto settings = settings_of(camera.url(scheme));
        settings.login = {"root", "hush-hush", {}};
        CHECK(says(told_by(settings), "it redirects to"));
        CHECK(says(camera.asked(), "Authorization: Digest"));
        CHECK_FALSE(says(camera.asked(), "Authorization: Basic"));
        CHECK(elsewhere.connections() == 0);
    }
}

TEST_CASE("network camera: a camera that asks for the login again and again gets few answers")
{
    std::atomic<int> nonce = 0;
    const Camera camera([&](Client& client, const std::string& request) {
        return client.send(hostile::rtsp(request, "401 No",
                                         "WWW-Authenticate: Digest realm=\"x\", stale=true, nonce=\""
                                             + std::to_string(++nonce) + "\"\r\n"));
    });
    auto settings = settings_of(camera.url("rtsp"));
    settings.login = {"root", "hush-hush", {}};
    CHECK_FALSE(told_by(settings).empty());
    CHECK(nonce <= 9);
}
