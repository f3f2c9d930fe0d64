// Network cameras that attack: what they send has limits, and they lead the drone to no other place. A twin without the
// limit shows each time that the attack works.
#include "capture.hpp"
#include "hostile_camera.hpp"
#include "video_source.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <optional>

using camera::open_url;
using camera::UrlLimits;
using camera::UrlSettings;
using hostile::Camera;
using hostile::Client;

namespace {

constexpr std::size_t mebibyte = 1 << 20;

/// Why the camera is refused, at the latest with its third picture; empty: it is not.
std::string told_by(const UrlSettings& settings)
{
    try {
        const auto source = open_url(settings, nullptr);
        for (int i = 0; i < 3 && source->next(); ++i) {
        }
    } catch (const std::exception& problem) {
        return problem.what();
    }
    return "";
}

UrlSettings settings_of(const std::string& url, UrlLimits limits = {})
{
    UrlSettings settings;
    settings.url = url;
    settings.limits = limits;
    return settings;
}

std::string told_by(const std::string& url, UrlLimits limits = {}) { return told_by(settings_of(url, limits)); }

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Answers every request with the same bytes.
Camera::Answer always(const std::string& bytes)
{
    return [bytes](Client& client, const std::string&) {
        client.send(bytes);
        return false;
    };
}

std::string redirection(const std::string& to)
{
    return "HTTP/1.1 302 Found\r\nLocation: " + to + "\r\nContent-Length: 0\r\n\r\n";
}

}  // namespace

TEST_CASE("network camera: pictures of a stream come, whatever stands before its first boundary")
{
    const auto jpeg = hostile::part(hostile::grey_jpeg(64, 48));
    for (const std::string before : {"", "\r\n"}) {
        const Camera camera([&](Client& client, const std::string&) {
            client.send(hostile::multipart + before);
            client.flood(jpeg, 4 * mebibyte);
            return false;
        });
        const auto source = open_url(settings_of(camera.url()), nullptr);
        for (int i = 0; i < 3; ++i) {
            const auto frame = source->next();
            REQUIRE(frame);
            CHECK(frame->image.size() == cv::Size(64, 48));
            CHECK(frame->index == i);
        }
    }
}

TEST_CASE("network camera: a picture of too many pixels is refused by its size, not decoded")
{
    const Camera camera(always(hostile::multipart + hostile::part(hostile::grey_jpeg(9000, 9000))));
    CHECK(says(told_by(camera.url()), "a picture of 9000x9000 pixels; at most 40000000 are accepted"));
    const auto without = open_url(settings_of(camera.url(), UrlLimits::none()), nullptr)->next();
    REQUIRE(without);
    CHECK(without->image.size() == cv::Size(9000, 9000));
}

TEST_CASE("network camera: a JPEG of many scans is refused, not decoded a thousand times")
{
    const Camera camera(always(hostile::multipart + hostile::part(hostile::grey_jpeg(64, 48, 101))));
    CHECK(says(told_by(camera.url()), "a JPEG of more than 100 scans"));
    CHECK_FALSE(says(told_by(camera.url(), UrlLimits::none()), "scans"));
}

TEST_CASE("network camera: a part that never ends is refused after 16 MiB")
{
    const std::string head = "--b\r\nContent-Type: image/jpeg\r\n", letters(mebibyte, 'x');
    for (const std::string length : {"", "Content-Length: 2147483646\r\n"}) {
        CAPTURE(length);
        const Camera camera([&](Client& client, const std::string&) {
            client.send(hostile::multipart + head + length + "\r\n");
            client.flood(letters, 96 * mebibyte);
            return false;
        });
        CHECK(says(told_by(camera.url()), "more than 16 MiB without a picture"));
        const auto with = camera.sent();
        CHECK(with < 32 * mebibyte);
        told_by(camera.url(), UrlLimits::none());
        CHECK(camera.sent() - with >= 96 * mebibyte);
    }
}

TEST_CASE("network camera: a redirection is told and not followed")
{
    const Camera elsewhere(always(hostile::multipart + hostile::part(hostile::grey_jpeg(64, 48))));
    const Camera camera(always(redirection(elsewhere.url("http", "/secret?x=1"))));
    CHECK(says(told_by(camera.url()),
               "it redirects to " + elsewhere.url("http", "/secret") + " (302), which is not followed"));
    CHECK(camera.connections() == 1);
    CHECK(elsewhere.connections() == 0);
    told_by(camera.url(), UrlLimits::none());
    CHECK(elsewhere.connections() == 1);
}

TEST_CASE("network camera: a playlist leads to no other address")
{
    const Camera elsewhere(always(hostile::ok + "\r\n"));
    const std::string to = elsewhere.url("http", "/a.ts");
    for (const std::string& text :
         {"Content-Type: application/vnd.apple.mpegurl\r\n\r\n#EXTM3U\n#EXT-X-VERSION:3\n#EXT-X-TARGETDURATION:1\n"
          "#EXTINF:1,\n"
              + to + "\n#EXT-X-ENDLIST\n",
          "Content-Type: text/plain\r\n\r\nffconcat version 1.0\nfile " + to + "\nfile /etc/passwd\n",
          std::string("Content-Type: application/sdp\r\n\r\nv=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=x\r\nc=IN IP4 "
                      "127.0.0.1\r\nt=0 0\r\nm=video 5004 RTP/AVP 26\r\n")}) {
        CAPTURE(text);
        const Camera camera(always(hostile::ok + text));
        CHECK(says(told_by(camera.url()), "playlists are not followed"));
        CHECK(elsewhere.connections() == 0);
    }
}

TEST_CASE("network camera: a redirection of RTSP is told and not followed")
{
    std::string to;
    const Camera elsewhere(always(""));
    std::atomic<int> asked = 0;
    const Camera camera([&](Client& client, const std::string& request) {
        if (++asked < 60)  // or else the twin would go on for 20 s
            client.send(hostile::rtsp(request, "302 Moved", "Location: " + to + "\r\n"));
        return false;
    });
    to = elsewhere.url("rtsp");
    CHECK(says(told_by(camera.url("rtsp")), "it redirects to " + to + " (302), which is not followed"));
    CHECK(elsewhere.connections() == 0);
    to = camera.url("rtsp");
    CHECK(says(told_by(camera.url("rtsp")), "it redirects to"));
    CHECK(camera.connections() == 2);
    told_by(camera.url("rtsp"), UrlLimits::none());
    CHECK(camera.connections() > 50);
}

TEST_CASE("network camera: an RTSP reply that announces gigabytes is not read")
{
    const std::string letters(mebibyte, 'a');
    const Camera camera([&](Client& client, const std::string& request) {
        client.send("RTSP/1.0 200 OK\r\n" + hostile::sequence(request)
                    + "Content-Type: application/sdp\r\nContent-Length: 2000000000\r\n\r\n");
        client.flood(letters, 96 * mebibyte);
        return false;
    });
    CHECK(says(told_by(camera.url("rtsp")), "it announces a reply of 2000000000 bytes; at most 65536"));
    const auto with = camera.sent();
    CHECK(with < 16 * mebibyte);
    told_by(camera.url("rtsp"), UrlLimits::none());
    CHECK(camera.sent() - with >= 96 * mebibyte);
}

TEST_CASE("network camera: an RTSP picture that never ends is refused after 16 MiB")
{
    const Camera camera([](Client& client, const std::string& request) {
        if (request.starts_with("DESCRIBE"))
            return client.send(hostile::rtsp(request, "200 OK", "Content-Type: application/sdp\r\n",
                                             "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=x\r\nt=0 0\r\nm=video 0 RTP/AVP "
                                             "96\r\na=rtpmap:96 H264/90000\r\na=control:t\r\n"));
        client.send(hostile::rtsp(request, "200 OK", "Session: 1\r\n" + hostile::transport(request)));
        for (unsigned number = 0; request.starts_with("PLAY") && number < 1600; ++number)
            client.send(hostile::h264_fragment(number, 60'000));
        return !request.starts_with("PLAY");
    });
    CHECK(says(told_by(camera.url("rtsp")), "more than 16 MiB without a picture"));
    const auto with = camera.sent();
    CHECK(with < 32 * mebibyte);
    told_by(camera.url("rtsp"), UrlLimits::none());
    CHECK(camera.sent() - with > 80 * mebibyte);
}

TEST_CASE("network camera: of many streams of an RTSP camera few are taken")
{
    std::string description = "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=x\r\nt=0 0\r\n";
    for (int i = 0; i < 40; ++i)
        description += "m=video 0 RTP/AVP 26\r\na=control:track" + std::to_string(i) + "\r\n";
    int taken = 0;
    const Camera camera([&](Client& client, const std::string& request) {
        if (request.starts_with("DESCRIBE"))
            return client.send(hostile::rtsp(request, "200 OK", "Content-Type: application/sdp\r\n", description));
        taken += request.starts_with("SETUP") ? 1 : 0;
        return !request.starts_with("PLAY")
               && client.send(hostile::rtsp(request, "200 OK", "Session: 1\r\n" + hostile::transport(request)));
    });
    told_by(camera.url("rtsp"));
    CHECK(taken == 16);
    told_by(camera.url("rtsp"), UrlLimits::none());
    CHECK(taken == 16 + 40);
}

TEST_CASE("network camera: one that announces many streams by HTTP is refused")
{
    const Camera camera([](Client& client, const std::string&) {
        client.send(hostile::ok + "Content-Type: video/mp2t\r\n\r\n");
        client.flood(hostile::transport_stream(30), mebibyte);
        return false;
    });
    CHECK(says(told_by(camera.url()), "it announces more than 16 streams"));
    CHECK_FALSE(says(told_by(camera.url(), UrlLimits::none()), "streams"));
}

TEST_CASE("network camera: no password is sent unencrypted unless that is allowed")
{
    const Camera http([](Client& client, const std::string&) {
        client.send("HTTP/1.1 401 No\r\nWWW-Authenticate:\v Basic realm=\"x\"\r\nContent-Length: 0\r\n\r\n");
        return false;
    });
    const Camera rtsp([](Client& client, const std::string& request) {
        return client.send(hostile::rtsp(request, "401 No", "WWW-Authenticate: Basic realm=\"x\"\r\n"));
    });
    for (const auto& [camera, url] : {std::pair(&http, http.url()), {&rtsp, rtsp.url("rtsp")}}) {
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

TEST_CASE("network camera: one that is refused is asked again after pauses that grow, and its condition says why")
{
    const Camera camera(always(redirection("http://192.0.2.1/")));
    const ::camera::Capture capture([&] { return open_url(settings_of(camera.url()), nullptr); }, 0,
                                    ::camera::Capture::AtEnd::open_again, [] {});
    std::this_thread::sleep_for(std::chrono::milliseconds(4000));
    CHECK(says(capture.condition(), "it redirects to http://192.0.2.1/ (302), which is not followed"));
    CHECK(camera.connections() >= 2);
    CHECK(camera.connections() <= 5);  // at 0, 0.5, 1.5 and 3.5 s, give or take
}
