// A drone for tests with two inputs, which counts the events of each.
#include <hive/drone.hpp>

namespace {

void join_drone(hive::Drone& drone)
{
    std::int64_t left = 0, right = 0;
    const auto counts = drone.output("counts", "application/json", "in the header: left, right");
    const auto emit = [&] { counts.emit({{"left", left}, {"right", right}}); };
    drone.on_event(
        "left", "*/*",
        [&](const hive::Event&) {
            ++left;
            emit();
        },
        "anything");
    drone.on_event(
        "right", "*/*",
        [&](const hive::Event&) {
            ++right;
            emit();
        },
        "anything");
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"join", "Counts the events of two inputs, for tests."}, join_drone);
}
