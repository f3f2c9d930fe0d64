// Everything that a camera can do wrong: no crash, no broken image, a condition that says what it is, and images
// again afterwards.
#include "stage.hpp"

#include <doctest/doctest.h>

using namespace stage;
using namespace std::chrono_literals;

namespace {

struct Wrong {
    const char *words, *undone, *condition;
};

void suffer(const EmulatedCamera& camera, hive::Application& application, hive::Collector& collector,
            const Wrong& wrong)
{
    CAPTURE(std::string(wrong.words));
    camera.behave(wrong.words);
    CHECK(comes_to_say(application, collector, wrong.condition, 8000ms));
    camera.behave(wrong.undone);
    CHECK(comes_to_say(application, collector, "", 12'000ms));
    take_images(collector, 3);
}

}  // namespace

TEST_CASE("axis misbehaviour: answers other than images are reported by their type")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"close_after=5"});  // so that every behaviour is met soon
    const auto drone = axis_drone(swarm, camera, {"resolution=160x120"});
    auto application = swarm.application();
    const auto collector = application.collect({{"axis", "image"}});
    for (const Wrong& wrong : {Wrong{"foreign=on", "foreign=off", "not a VAPIX device"},
                               {"html=on", "html=off", "not an image: the camera sends text/html"},
                               {"redirect=http://a:b@127.0.0.1:1/x?y", "redirect=", "http://127.0.0.1:"},
                               {"status=503", "status=200", "http://127.0.0.1:"},
                               {"huge_head=on", "huge_head=off", "the head of the answer is larger"},
                               {"auth=digest", "auth=none", "auth_failed"},
                               {"unauthorised=on", "unauthorised=off", "auth_failed"}})
        suffer(camera, application, *collector, wrong);
    CHECK(has(swarm.log("axis"), "points to http://***@127.0.0.1:1/x (302), which is not followed"));
    CHECK(has(swarm.log("axis"), "answers with status 503"));
}

TEST_CASE("axis misbehaviour: broken streams give no broken image")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"close_after=10"});
    const auto drone = axis_drone(swarm, camera, {"resolution=160x120"});
    auto application = swarm.application();
    const auto collector = application.collect({{"axis", "image"}});
    for (const Wrong& wrong : {Wrong{"truncated=on&close_after=-1", "truncated=off&close_after=10",
                                     "stalled: no complete image: it is cut short"},
                               {"truncated=on&length=missing&close_after=-1",
                                "truncated=off&length=right&close_after=10", "stalled: no complete image"},
                               {"length=short", "length=right", "the camera ended the stream"},
                               {"length=huge", "length=right", "the camera announces an image of more than 16 MiB"},
                               {"endless_part=on", "endless_part=off", "an image of more than 16 MiB"},
                               {"endless_head=on", "endless_head=off", "a head of more than 8 KiB"},
                               {"cut_after=0", "cut_after=-1", "the camera ended the stream"},
                               {"close_after=0", "close_after=10", "the camera ended the stream"},
                               {"bytes_per_s=100&close_after=-1", "bytes_per_s=0&close_after=10", "stalled"}})
        suffer(camera, application, *collector, wrong);
}

TEST_CASE("axis misbehaviour: quirks of streams cost nothing")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"close_after=4"});
    const auto drone = axis_drone(swarm, camera, {"resolution=160x120"});
    auto application = swarm.application();
    const auto collector = application.collect({{"axis", "image"}});
    for (const std::string words : {"boundary=dashed", "boundary=quoted", "boundary=tight", "length=missing",
                                    "line_end=lf", "garbage=on&length=right", "length=text&garbage=off"}) {
        CAPTURE(words);
        camera.behave(words);
        take_images(*collector, 10);
    }
}

TEST_CASE("axis misbehaviour: streams that are cut in the middle of an image, again and again, give whole images only")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"cut_after=3", "fps=50"});
    const auto drone = axis_drone(swarm, camera, {"resolution=320x240"});
    auto application = swarm.application();
    const auto collector = application.collect({{"axis", "image"}});
    take_images(*collector, 9);
    camera.behave("length=missing");
    take_images(*collector, 9);
    CHECK(camera.count("pictures") >= 18 + 4);  // those that were cut were begun
}

TEST_CASE("axis misbehaviour: no connection to an address that is not allowed")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm);
    const auto drone = swarm.drone("axis", "axis", {"url=" + camera.url()});
    auto application = swarm.application();
    CHECK(comes_to_say(application, "the address 127.0.0.1 is not allowed"));
    application.set("axis", {{"url", "http://localhost:9"}});
    CHECK(comes_to_say(application, "the address"));
    CHECK(camera.count("connections") == 0);
}

TEST_CASE("axis misbehaviour: a truncated or invalid single image is dropped; the next one is forwarded")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm);
    const auto drone = axis_drone(swarm, camera, {"resolution=160x120", "pace=demand"});
    auto application = swarm.application();
    const auto collector =
        application.collect({{"axis", "image"}}, {.connection = {.window = 1, .group = {}, .lease = {}}});
    take_images(*collector, 3);
    for (const Wrong& wrong : {Wrong{"truncated=on", "truncated=off", "no complete image: it is cut short"},
                               {"html=on", "html=off", "not an image: the camera sends text/html"}})
        suffer(camera, application, *collector, wrong);
}
