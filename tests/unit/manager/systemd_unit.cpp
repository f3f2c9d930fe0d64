// Units of systemd: every word comes through as it is.
#include "engines/systemd_unit.hpp"

#include <doctest/doctest.h>

TEST_CASE("systemd unit: what systemd would read otherwise is quoted, and no text becomes a line of its own")
{
    CHECK_EQ(hive::unit_name("cam.1"), "hive-cam.1.service");
    CHECK_EQ(hive::quoted_for_systemd("source=a \"b\" \\c $HOME 100%\nd\re"),
             "\"source=a \\\"b\\\" \\\\c $$HOME 100%%\\nd\\x0de\"");
}

TEST_CASE("systemd unit: amounts are limits")
{
    const hive::SwarmDrone drone{.name = "a", .kind = "camera", .cpus = 2, .memory_mib = 512};
    const auto properties = hive::unit_properties(drone);
    const std::vector<std::string> limits{"CPUQuota=200%", "MemoryMax=512M"};
    REQUIRE(properties.size() == 6);
    CHECK(std::vector(properties.begin() + 4, properties.end()) == limits);
}
