// Logging in: every scheme of a camera, wrong passwords, and secrets that stay secret.
#include "stage.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <functional>
#include <sys/stat.h>

using namespace stage;
using namespace std::chrono_literals;

TEST_CASE(
    "axis login: images come with no login, basic, and digest with and without qop or with nonces that grow stale")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm);
    const auto file = credentials_file(swarm, "root:pass");
    const auto drone = axis_drone(swarm, camera, {"credentials=" + file, "basic_over_http=on", "resolution=320x240"});
    auto application = swarm.application();
    const auto collector = application.collect({{"axis", "image"}});
    take_images(*collector, 2);
    for (const std::string words :
         {"auth=basic", "auth=digest", "auth=digest&qop=off", "auth=basic_digest&qop=on", "auth=digest&nonce_uses=1"}) {
        CAPTURE(words);
        camera.behave(words);
        application.set("axis", {{"allow_address", "127.0.0.1,::1"}});  // another link, which logs in again
        REQUIRE(comes_to_say(application, ""));
        take_images(*collector, 3);
        CHECK(application.set("axis", {{"brightness", 60}}) == hive::Json{{"brightness", 60}});
        application.set("axis", {{"allow_address", "127.0.0.1"}, {"brightness", -1}});
    }
    CHECK(camera.count("wrong_logins") == 0);
}

TEST_CASE("axis login: a wrong password is tried three times, reported, and not retried until the file changes")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"auth=basic_digest"});
    const auto file = credentials_file(swarm, "root:wrong");
    const auto drone = axis_drone(swarm, camera, {"credentials=" + file});
    auto application = swarm.application();
    REQUIRE(comes_to_say(application, "auth_failed: the camera refuses the password of root"));
    CHECK(camera.count("wrong_logins") == 3);
    const int connections = camera.count("connections");
    const auto set = swarm.hivectl({"set", "axis", "brightness=60"});
    CHECK(set.exit_code != 0);
    CHECK(has(set.err, "auth_failed"));
    const auto collector = application.collect({{"axis", "image"}});
    CHECK_FALSE(collector->next(2500ms));  // long enough for two more tries at its former pace
    CHECK(camera.count("wrong_logins") == 3);
    CHECK(camera.count("connections") == connections);
    credentials_file(swarm, "root:pass");
    take_images(*collector, 2);
    CHECK(comes_to_say(application, ""));
    CHECK(camera.count("wrong_logins") == 3);
}

TEST_CASE("axis login: when the camera takes the password again, a touch of the file or a set to the same is enough")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"auth=digest", "close_after=5"});
    const auto file = credentials_file(swarm, "root:pass");
    const auto drone = axis_drone(swarm, camera, {"credentials=" + file});
    auto application = swarm.application();
    const auto again = [&](const std::function<void()>& way) {
        camera.behave("unauthorised=on");
        REQUIRE(comes_to_say(application, "auth_failed: the camera refuses the password of root", 10'000ms));
        camera.behave("unauthorised=off");
        way();
        CHECK(comes_to_say(application, ""));
    };
    again([&] { std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) + 1s); });
    again([&] { CHECK(swarm.hivectl_done({"set", "axis", "credentials=" + file}) == file + "\n"); });
    again([&] { swarm.hivectl_done({"set", "axis", "url=" + camera.url()}); });
}

TEST_CASE("axis login: a set that is refused tries no password again, one that changes nothing tries it once")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"auth=digest"});
    const auto drone = axis_drone(swarm, camera, {"credentials=" + credentials_file(swarm, "root:wrong")});
    auto application = swarm.application();
    REQUIRE(comes_to_say(application, "auth_failed"));
    for (const std::string setting : {"brightness=60", "url=ftp://x"})
        CHECK(swarm.hivectl({"set", "axis", setting}).exit_code != 0);
    const auto collector = application.collect({{"axis", "image"}});
    CHECK_FALSE(collector->next(1500ms));
    CHECK(camera.count("wrong_logins") == 3);
    application.set("axis", {{"url", camera.url()}});
    CHECK(eventually([&] { return camera.count("wrong_logins") == 4; }));
    CHECK_FALSE(collector->next(1500ms));
    CHECK(camera.count("wrong_logins") == 4);
}

TEST_CASE("axis login: over http a password is not sent readable unless that is allowed")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"auth=basic"});
    const auto drone = axis_drone(swarm, camera, {"credentials=" + credentials_file(swarm, "root:wrong")});
    auto application = swarm.application();
    REQUIRE(comes_to_say(application, "auth_failed: the camera offers only basic authentication"));
    CHECK(camera.count("wrong_logins") == 0);
}

TEST_CASE("axis login: a required and missing login is reported; the environment can supply it")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"auth=digest"});
    auto application = swarm.application();
    {
        const auto drone = axis_drone(swarm, camera);
        CHECK(comes_to_say(application, "auth_failed: login required"));
    }
    const auto drone = axis_drone(swarm, camera, {}, {"HIVE_AXIS_USER=root", "HIVE_AXIS_PASSWORD=pass"});
    CHECK(comes_to_say(application, ""));
    take_images(*application.collect({{"axis", "image"}}), 1);
}

TEST_CASE("axis login: half a login in the environment is refused at the start, with the missing variable")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"auth=digest"});
    const auto started =
        swarm.run({"/usr/bin/env", "HIVE_AXIS_USER=root", swarm.program("hive-axis").string(), "--name", "axis",
                   "--set", "url=" + camera.url(), "--set", "allow_address=127.0.0.1"});
    CHECK(started.exit_code != 0);
    CHECK(has(started.err, "HIVE_AXIS_PASSWORD is missing"));
    CHECK(camera.count("connections") == 0);
}

TEST_CASE("axis login: a password is neither on a command line nor in the log nor in a parameter, and a URL with one "
          "is refused")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"auth=digest", "credentials=" + credentials_file(swarm, "root:hush-hush")});
    const auto drone = axis_drone(swarm, camera, {"credentials=" + credentials_file(swarm, "root:hush-hush")});
    auto application = swarm.application();
    take_images(*application.collect({{"axis", "image"}}), 1);
    const auto refused = swarm.hivectl({"set", "axis", "url=http://root:hush-hush@127.0.0.1"});
    CHECK(refused.exit_code != 0);
    CHECK(has(refused.err, "credentials"));
    CHECK_FALSE(has(refused.out + refused.err, "hush-hush"));
    const auto started = swarm.run(
        {swarm.program("hive-axis").string(), "--name", "other", "--set", "url=http://root:hush-hush@127.0.0.1"});
    CHECK(started.exit_code != 0);
    CHECK_FALSE(has(started.out + started.err, "hush-hush"));
    CHECK_FALSE(has(text_of("/proc/" + std::to_string(drone.pid()) + "/cmdline"), "hush-hush"));
    CHECK_FALSE(has(swarm.log("axis"), "hush-hush"));
    CHECK_FALSE(has(swarm.hivectl_done({"get", "axis"}), "hush-hush"));
    CHECK_FALSE(has(text_of(swarm.home() / "axis.state"), "hush-hush"));
}

TEST_CASE("axis login: a credentials file that others can read is refused, and the old camera continues")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm);
    const auto drone = axis_drone(swarm, camera);
    const auto file = credentials_file(swarm, "root:pass");
    ::chmod(file.c_str(), 0644);
    const auto refused = swarm.hivectl({"set", "axis", "credentials=" + file});
    CHECK(refused.exit_code != 0);
    CHECK(has(refused.err, "chmod 600"));
    auto application = swarm.application();
    take_images(*application.collect({{"axis", "image"}}), 1);
}

TEST_CASE("axis login: a set sends it to no other camera than the one that it was given for")
{
    const Swarm swarm;
    const EmulatedCamera camera(swarm, {"auth=digest"});
    const auto file = credentials_file(swarm, "root:pass");
    const auto drone = axis_drone(swarm, camera, {"credentials=" + file});
    auto application = swarm.application();
    take_images(*application.collect({{"axis", "image"}}), 1);
    const Swarm elsewhere;
    const EmulatedCamera thief(elsewhere, {"auth=basic"});
    const auto other_login = credentials_file(elsewhere, "admin:another");
    const auto refused = [&](std::vector<std::string> settings) {
        settings.insert(settings.begin(), {"set", "axis"});
        const auto set = swarm.hivectl(settings);
        return set.exit_code != 0 && has(set.err, "the login was given for");
    };
    CHECK(refused({"url=" + thief.url(), "basic_over_http=on"}));
    CHECK(refused({"credentials=" + other_login}));  // nor does another login go to this camera
    CHECK(refused({"url=" + thief.url(), "credentials=" + other_login, "basic_over_http=on"}));
    credentials_file(elsewhere, "admin:another\n" + camera.url());
    CHECK(refused({"url=" + thief.url(), "credentials=" + other_login, "basic_over_http=on"}));
    CHECK(thief.count("connections") == 0);

    credentials_file(elsewhere, "root:pass\n" + thief.url());
    swarm.hivectl_done({"set", "axis", "url=" + thief.url(), "credentials=" + other_login, "basic_over_http=on"});
    CHECK(comes_to_say(application, ""));
}
