// Parameters that the camera accepts, changes and refuses; and images on demand.
#include "stage.hpp"

#include <doctest/doctest.h>

using namespace stage;
using namespace std::chrono_literals;
using hive::Json;

namespace {

constexpr const char* brightness = "ImageSource.I0.Sensor.Brightness";
constexpr const char* resolution = "Image.I0.Appearance.Resolution";

/// The size of images becomes this one.
bool sizes_become(hive::Collector& collector, int width)
{
    for (int i = 0; i < 200; ++i)
        if (const auto event = collector.next(patient(5000ms)); event && event->header.at("width") == width)
            return true;
    return false;
}

}  // namespace

TEST_CASE("axis settings: set and get return the values that the camera reports")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"step=5"});
    const auto drone = axis_drone(swarm, camera);
    auto application = swarm.application();
    REQUIRE(comes_to_say(application, ""));
    CHECK(application.set("axis", {{"brightness", 60}, {"exposure", "hold"}})
          == Json{{"brightness", 60}, {"exposure", "hold"}});
    CHECK(camera.parameter(brightness) == "60");
    CHECK(application.set("axis", {{"brightness", 73}}) == Json{{"brightness", 70}});
    CHECK(application.get("axis", {"brightness", "exposure", "colour"})
          == Json{{"brightness", 70}, {"exposure", "hold"}, {"colour", -1}});
    CHECK(swarm.hivectl_done({"set", "axis", "colour=14"}) == "10\n");
    const int updates = camera.count("updates");
    application.set("axis", {{"colour", -1}});  // as the camera has it
    application.set("axis", {{"colour", 10}});  // which it has already
    CHECK(camera.count("updates") == updates);
}

TEST_CASE("axis settings: another camera is another epoch, and a parameter of the same one is not")
{
    const Swarm swarm, elsewhere;
    const EmulatedCamera one(swarm), other(elsewhere);
    const auto drone = axis_drone(swarm, one);
    auto application = swarm.application();
    const auto images = application.collect({{"axis", "image"}});
    const auto epoch = [&] {
        take_images(*images, 1);
        const auto event = images->next(patient(5000ms));
        return event ? event->identity.epoch : 0;
    };
    const auto before = epoch();
    application.set("axis", {{"brightness", 60}});
    CHECK(epoch() == before);
    application.set("axis", {{"url", other.url()}});
    CHECK(epoch() > before);
}

TEST_CASE("axis settings: what the camera refuses is refused with its reason, and of several values none stays")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm);
    const auto drone = axis_drone(swarm, camera, {"brightness=40"});
    auto application = swarm.application();
    take_images(*application.collect({{"axis", "image"}}), 1);  // the brightness has been written
    const auto refused = swarm.hivectl({"set", "axis", "resolution=9x9", "brightness=80"});
    CHECK(refused.exit_code != 0);
    CHECK(has(refused.err, "the camera refuses: Error: Error setting 'root.Image.I0.Appearance.Resolution' to '9x9'!"));
    CHECK(application.get("axis", {"resolution", "brightness"}) == Json{{"resolution", ""}, {"brightness", 40}});
    CHECK(camera.parameter(brightness) == "40");
    CHECK(camera.parameter(resolution) == "640x480");
    take_images(*application.collect({{"axis", "image"}}), 1);
}

TEST_CASE("axis settings: another resolution changes the images of a running stream")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm);
    const auto drone = axis_drone(swarm, camera, {"resolution=160x120"});
    auto application = swarm.application();
    const auto collector = application.collect({{"axis", "image"}});
    CHECK(sizes_become(*collector, 160));
    application.set("axis", {{"resolution", "320x240"}, {"compression", 70}});
    CHECK(sizes_become(*collector, 320));
    CHECK(camera.parameter("Image.I0.Appearance.Compression") == "70");
}

TEST_CASE(
    "axis settings: values from before the camera was found are applied when it is, and told when it refuses them")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"down=on"});
    const auto drone = axis_drone(swarm, camera, {"brightness=20", "exposure=whatever"});
    auto application = swarm.application();
    REQUIRE(comes_to_say(application, "connection refused"));
    const auto collector = application.collect({{"axis", "image"}});
    camera.behave("down=off");
    CHECK(comes_to_say(application, "the camera refuses: Error: Error setting 'root.ImageSource.I0.Sensor.Exposure'"));
    take_images(*collector, 2);
    application.set("axis", {{"exposure", "auto"}});
    CHECK(comes_to_say(application, ""));
    application.set("axis", {{"allow_address", "127.0.0.1,::1"}});  // found again
    CHECK(eventually([&] { return camera.parameter(brightness) == "20"; }));
}

TEST_CASE("axis settings: old firmware takes updates on its own path")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"old_firmware=on"});
    const auto drone = axis_drone(swarm, camera);
    auto application = swarm.application();
    REQUIRE(comes_to_say(application, ""));
    CHECK(application.set("axis", {{"brightness", 30}}) == Json{{"brightness", 30}});
    CHECK(camera.parameter(brightness) == "30");
}

TEST_CASE("axis settings: with pace=demand the camera is asked for one image for each that is received")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm);
    const auto drone = axis_drone(swarm, camera, {"pace=demand", "resolution=160x120"});
    auto application = swarm.application();
    REQUIRE(comes_to_say(application, ""));
    CHECK(camera.count("pictures") == 0);
    const auto collector =
        application.collect({{"axis", "image"}}, {.connection = {.window = 1, .group = {}, .lease = {}}});
    std::int64_t last = 0;
    for (int i = 0; i < 20; ++i) {
        const auto event = collector->next(patient(5000ms));
        REQUIRE(event);
        CHECK(event->identity.lossless);
        CHECK(event->identity.sequence == ++last);
    }
    CHECK(camera.count("pictures") <= 22);  // the next is made while this one is looked at
}

TEST_CASE("axis settings: without a camera the drone runs and reports the missing url")
{
    const Swarm swarm;
    const auto drone = swarm.drone("axis", "axis");
    auto application = swarm.application();
    CHECK(comes_to_say(application, "no camera: set url"));
    CHECK(application.set("axis", {{"brightness", 60}}) == Json{{"brightness", 60}});
    CHECK(has(swarm.hivectl({"set", "axis", "url=ftp://x"}).err, "write http:// or https://"));
}

TEST_CASE("axis settings: a certificate that is not there is refused at once, at the start and by set")
{
    const Swarm swarm;
    const auto started =
        swarm.run({swarm.program("hive-axis").string(), "--name", "other", "--set", "certificate=/nowhere/x.pem"});
    CHECK(started.exit_code != 0);
    CHECK(has(started.err, "certificate: no such file: /nowhere/x.pem"));
    const auto drone = swarm.drone("axis", "axis", {"url=https://192.0.2.10"});
    CHECK(has(swarm.hivectl({"set", "axis", "certificate=/nowhere/x.pem"}).err,
              "certificate: no such file: /nowhere/x.pem"));
    CHECK(swarm.hivectl_done({"get", "axis", "certificate"}).find("/nowhere") == std::string::npos);
}

TEST_CASE("axis emulator: says which address or port it cannot have, with a hint at its help only when a word is wrong")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm);
    const auto emulated = [&](const std::string& word) {
        auto words = emulator;
        words.push_back(word);
        return swarm.run(words);
    };
    const std::string taken = camera.url().substr(camera.url().rfind(':') + 1);
    for (const std::string word : {"port", "control"}) {
        const auto refused = emulated(word + "=" + taken);
        CHECK(refused.exit_code == 1);
        CHECK(refused.err
              == "axis_camera.py: cannot listen at 127.0.0.1, " + word + "=" + taken + ": Address already in use\n");
    }
    CHECK(has(emulated("address=192.0.2.1").err, "cannot listen at 192.0.2.1, port=0: "));
    const auto wrong = emulated("address=300.1.1.1");
    CHECK(wrong.exit_code == 2);
    CHECK(has(wrong.err, "address=300.1.1.1 is not an IPv4 address"));
}

TEST_CASE("axis settings: the header of an image has the fields that the page shows")
{
    const std::string page = text_of(HIVE_SOURCE_DIR "/drones/axis/README.md"), begin = "Its header: `";
    const std::size_t at = page.find(begin);
    REQUIRE(at != std::string::npos);
    const Json example =
        Json::parse(page.substr(at + begin.size(), page.find('`', at + begin.size()) - at - begin.size()));
    const Swarm swarm;
    const EmulatedCamera camera(swarm);
    const auto drone = axis_drone(swarm, camera);
    auto application = swarm.application();
    const auto event = application.collect({{"axis", "image"}})->next(patient(5000ms));
    REQUIRE(event);
    REQUIRE(event->header.size() == example.size());
    for (const auto& [name, value] : example.items())
        CHECK(event->header.at(name).type() == value.type());
    CHECK(event->header.at("source") == camera.url());
}
