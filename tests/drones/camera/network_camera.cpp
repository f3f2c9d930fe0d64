// Network cameras that attack by HTTP: their data has limits, and they cannot redirect the drone. A twin
// without the limit shows each time that the attack works.
#include "capture.hpp"
#include "network_stage.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

using namespace network;

TEST_CASE("network camera: images of a stream arrive, with any bytes before its first boundary")
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

TEST_CASE("network camera: an image of too many pixels is refused by its size, not decoded")
{
    const Camera camera(always(hostile::multipart + hostile::part(hostile::grey_jpeg(9000, 9000))));
    CHECK(says(told_by(camera.url()), "an image of 9000x9000 pixels; at most 40000000 are accepted"));
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
        CHECK(says(told_by(camera.url()), "more than 16 MiB without an image"));
        const auto with = camera.sent();
        CHECK(with < 32 * mebibyte);
        told_by(camera.url(), UrlLimits::none());
        CHECK(camera.sent() - with >= 96 * mebibyte);
    }
}

TEST_CASE("network camera: a redirection is reported and not followed")
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

TEST_CASE("network camera: a refused one is retried after growing pauses, with the reason in its condition")
{
    const Camera camera(always(redirection("http://192.0.2.1/")));
    const ::camera::Capture capture([&] { return open_url(settings_of(camera.url()), nullptr); }, 0,
                                    ::camera::Capture::AtEnd::open_again, [] {});
    std::this_thread::sleep_for(std::chrono::milliseconds(4000));
    CHECK(says(capture.condition(), "it redirects to http://192.0.2.1/ (302), which is not followed"));
    CHECK(camera.connections() >= 2);
    CHECK(camera.connections() <= 5);  // at 0, 0.5, 1.5 and 3.5 s, give or take
}
