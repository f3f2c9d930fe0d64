// A drone for tests that keeps state between events, so that its work cannot be shared; it accepts only ticks.
#include <hive/drone.hpp>

namespace {

void counter(hive::Drone& drone)
{
    std::int64_t count = 0;
    const auto total = drone.output("total", "application/json", "in the header: count");
    drone.on_event(
        "tick", "application/octet-stream",
        [&](const hive::Event&) {
            total.emit({{"count", ++count}});
        },
        "what is counted");
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {.kind = "counter", .summary = "Counts events, for tests.", .stateful = true},
                           counter);
}
