// Tests of finding the programs of drones.
#include "programs.hpp"
#include "programs_for_tests.hpp"

#include <doctest/doctest.h>

#include <algorithm>

TEST_CASE("programs: what is called hive-KIND is a drone's, but for emulators of devices")
{
    const Programs programs({"hive-toy", "hive-toy-emulator", "beehive-toy"});
    const auto kinds = hivectl::kinds();
    CHECK(std::ranges::count(kinds, "toy") == 1);
    CHECK(std::ranges::count(kinds, "toy-emulator") == 0);
    CHECK(hivectl::program_of("toy"));
    CHECK_FALSE(hivectl::program_of("toy-emulator"));
    CHECK_FALSE(hivectl::program_of("toys"));
}
