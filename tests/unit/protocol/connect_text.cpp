// A connection as one word of a command line.
#include <hive/error.hpp>
#include <hive/protocol/connect_text.hpp>

#include <doctest/doctest.h>

using namespace std::chrono_literals;
using hive::protocol::connect_from_text;

TEST_CASE("connect text: sender, output and input; the input may be left out")
{
    const auto whole = connect_from_text("image=camera.image");
    CHECK(whole.input == "image");
    CHECK(whole.drone == "camera");
    CHECK(whole.output == "image");
    CHECK(whole.address.empty());
    CHECK(whole.options == hive::ConnectionOptions{});
    const auto short_one = connect_from_text("cam.left-2.image");
    CHECK(short_one.input.empty());
    CHECK(short_one.drone == "cam.left-2");
    CHECK(short_one.output == "image");
}

TEST_CASE("connect text: every option")
{
    const auto shared =
        connect_from_text("image=camera.image,at=tcp://[::1]:7700,share,lease=1.5,window=4,encoding=jpeg:60");
    CHECK(shared.address == "tcp://[::1]:7700");
    CHECK(shared.options.group == "camera");
    CHECK(shared.options.lease == 1500ms);
    CHECK(shared.options.window == 4);
    CHECK(shared.options.encoding == "jpeg:60");
    CHECK(connect_from_text("a.b,group=crew").options.group == "crew");
    CHECK(connect_from_text("a.b,share,group=crew").options.group == "crew");
    CHECK(connect_from_text("a.b,group=crew,share").options.group == "crew");
    const auto watched = connect_from_text("a.b,stream,notify,first_frame");
    CHECK(watched.options.transfer == hive::Transfer::streaming);
    CHECK(watched.options.delivery == hive::Delivery::notification);
    CHECK(watched.options.first_frame);
}

TEST_CASE("connect text: what is written is read again as the same")
{
    for (const char* text :
         {"camera.image", "image=camera.image", "image=camera.image,at=tcp://cam1:7700,window=4,encoding=jpeg:60",
          "a.b,stream,notify,first_frame", "x=a.b,group=crew,lease=0.05", "x=a.b,group=crew,lease=86400"})
        CHECK(to_text(connect_from_text(text)) == text);
}

TEST_CASE("connect text: whom a sender expects")
{
    const auto whole = hive::protocol::expect_from_text("image=face.left.image,group=faces");
    CHECK(whole.output == "image");
    CHECK(whole.receiver == "face.left.image");
    CHECK(whole.group == "faces");
    for (const char* text : {"face.image", "tick=face.image", "tick=face.image,group=faces"})
        CHECK(to_text(hive::protocol::expect_from_text(text)) == text);
    for (const char* text : {"", "face", "image=face", "=face.image", "../x=face.image", "face.", ".image",
                             "face.image,", "face.image,window=2", "face.image,group=", "face.image,group=a b"})
        CHECK_THROWS_AS(static_cast<void>(hive::protocol::expect_from_text(text)), hive::Error);
}

TEST_CASE("connect text: mistakes are named")
{
    const std::pair<const char*, const char*> mistakes[]{
        {"", "names no output"},
        {"camera", "names no output"},
        {"image=camera", "names no output"},
        {"image=.image", "drone"},
        {"image=camera.", "output"},
        {"=camera.image", "input"},
        {"../x=camera.image", "input"},
        {"camera.image,", "is not an option"},
        {"camera.image,widow=2", "is not an option"},
        {"camera.image,stream=yes", "is not an option"},
        {"camera.image,window", "needs a value"},
        {"camera.image,window=", "needs a value"},
        {"camera.image,window=0", "from 1 to 64"},
        {"camera.image,window=65", "from 1 to 64"},
        {"camera.image,window=2x", "from 1 to 64"},
        {"camera.image,window=2,window=3", "given twice"},
        {"camera.image,group=a b", "group"},
        {"camera.image,share,lease=nan", "number of seconds"},
        {"camera.image,share,lease=0.01", "number of seconds"},
        {"camera.image,lease=2", "shared work"},
        {"camera.image,stream,window=2", "window conflicts with stream"},
        {"camera.image,share,stream", "stream"},
        {"camera.image,share,first_frame", "first_frame"},
        {"camera.image,encoding=jpeg:x", "encoding"}};
    for (const auto& [text, reason] : mistakes) {
        CAPTURE(text);
        try {
            static_cast<void>(connect_from_text(text));
            FAIL_CHECK("it was read");
        } catch (const hive::Error& error) {
            CHECK(error.code() == hive::Errc::invalid_argument);
            CHECK_MESSAGE(std::string(error.what()).find(reason) != std::string::npos, error.what());
        }
    }
}

TEST_CASE("connect text: every millisecond of a lease comes back")
{
    auto connect = connect_from_text("a.out,group=g");
    for (const std::int64_t ms : {50, 999, 1005, 12'345'678, 86'399'999}) {
        connect.options.lease = std::chrono::milliseconds(ms);
        CHECK(connect_from_text(hive::protocol::to_text(connect)).options.lease == connect.options.lease);
    }
}
