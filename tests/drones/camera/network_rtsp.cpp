// Network cameras that attack by RTSP, each with a twin without the limit.
#include "network_stage.hpp"

#include <doctest/doctest.h>

using namespace network;

TEST_CASE("network camera: a redirection of RTSP is reported and not followed")
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

TEST_CASE("network camera: an RTSP image that never ends is refused after 16 MiB")
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
    CHECK(says(told_by(camera.url("rtsp")), "more than 16 MiB without an image"));
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

TEST_CASE("network camera: the frame rate is read from the description of an RTSP stream if its images lack it")
{
    for (const std::string rate : {"a=framerate:12.5\r\n", "a=framerate:1e9\r\n", ""}) {
        CAPTURE(rate);
        const Camera camera([&](Client& client, const std::string& request) {
            if (request.starts_with("DESCRIBE"))
                return client.send(hostile::rtsp(request, "200 OK", "Content-Type: application/sdp\r\n",
                                                 "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=x\r\nt=0 0\r\n"
                                                 "m=video 0 RTP/AVP 26\r\n"
                                                     + rate + "a=control:t\r\n"));
            client.send(hostile::rtsp(request, "200 OK", "Session: 1\r\n" + hostile::transport(request)));
            for (unsigned number = 0; request.starts_with("PLAY") && number < 5; ++number)
                client.send(hostile::small_rtp_jpeg(number));
            return true;
        });
        const auto frame = open_url(settings_of(camera.url("rtsp")), nullptr)->next();
        REQUIRE(frame);
        CHECK(frame->image.size() == cv::Size(16, 16));
        CHECK(frame->fps == (rate.ends_with("12.5\r\n") ? 12.5 : 0));
    }
}
