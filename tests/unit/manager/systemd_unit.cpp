// Units of systemd: every word comes through as it is.
#include "engines/systemd_unit.hpp"

#include <hive/error.hpp>

#include <process.hpp>

#include <doctest/doctest.h>

using hive::test::has;

TEST_CASE("systemd unit: what systemd would read otherwise is quoted")
{
    const hive::SwarmDrone drone{.name = "cam.1", .kind = "camera", .restart = hive::Restart::on_failure};
    const auto text = hive::unit_text(drone,
                                      {.program = "/opt/my drones/hive-camera",
                                       .arguments = {"--set", "source=a \"b\" \\c $HOME 100%\nd"},
                                       .environment = {"HIVE_HOME=/run/100%/$x"}},
                                      "/run/100%/cam.1.log");
    CHECK(hive::unit_name(drone.name) == "hive-cam.1.service");
    CHECK(has(text, "\nExecStart=\"/opt/my drones/hive-camera\" \"--set\" "
                    "\"source=a \\\"b\\\" \\\\c $$HOME 100%%\\nd\"\n"));
    CHECK(has(text, "\nEnvironment=\"HIVE_HOME=/run/100%%/$x\"\n"));
    CHECK(has(text, "\nStandardOutput=append:/run/100%%/cam.1.log\n"));
    CHECK(has(text, "\nRestart=on-failure\n"));
    CHECK(has(text, "\nType=notify\n"));
}

TEST_CASE("systemd unit: no text becomes a line of its own, and amounts are limits")
{
    const hive::SwarmDrone drone{.name = "a", .kind = "x\nExecStartPre=/bin/false\r.py", .cpus = 2, .memory_mib = 512};
    const auto text = hive::unit_text(drone, {"/usr/bin/python3", {drone.kind}, {}}, "/log");
    for (const char* line : {"\nExecStartPre", "\r"})
        CHECK_FALSE_MESSAGE(has(text, line), text);
    CHECK(has(text, "\nCPUQuota=200%\nMemoryMax=512M\n"));
    CHECK_THROWS_AS(hive::unit_text(drone, {"/bin/x", {}, {}}, "/home\nExecStartPre=x/log"), hive::Error);
}

TEST_CASE("systemd unit: what could not be stopped is refused")
{
    hive::SwarmDrone drone{.name = "camera", .kind = "camera"};
    CHECK(has(hive::unit_text(drone, {"/bin/hive-camera", {}, {}}, "/log"), "\nRestart=no\n"));
    drone.restart = hive::Restart::always;
    CHECK_THROWS_WITH_AS(hive::unit_text(drone, {"/bin/hive-camera", {}, {}}, "/log"), doctest::Contains("cannot stop"),
                         hive::Error);
}
