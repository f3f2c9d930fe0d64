// What a drone's core does before it runs.
#include "drone_core.hpp"

#include <doctest/doctest.h>

using hive::event::steady_us;
using hive::event::wall_us;

TEST_CASE("drone core: a capture time that cannot be told is unknown, because receivers refuse a negative one")
{
    hive::DroneCore core({"kind", "for a test"}, {});
    const auto output = core.emitter().add_output({"output", "*/*", ""}, {});
    const auto now = core.emitter().fresh_identity(output, wall_us(), false);
    CHECK(now.captured_us > 0);
    CHECK(now.monotonic_us > 0);
    const auto before_the_start = core.emitter().fresh_identity(output, wall_us() - steady_us() - 1'000'000, false);
    CHECK(before_the_start.captured_us > 0);
    CHECK(before_the_start.monotonic_us == 0);
    const auto before_1970 = core.emitter().fresh_identity(output, -1, false);
    CHECK(before_1970.captured_us == 0);
    CHECK(before_1970.monotonic_us == 0);
    const auto beyond_the_protocol = core.emitter().fresh_identity(output, hive::max_json_integer + 1, false);
    CHECK(beyond_the_protocol.captured_us == 0);
    CHECK(beyond_the_protocol.sequence == 1);
}
