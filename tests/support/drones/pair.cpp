// A drone for tests that joins the events of two inputs by their capture.
#include <hive/drone.hpp>

namespace {

void pair_drone(hive::Drone& drone)
{
    const auto set = drone.output("set", "application/json", "in the header: index of the left event");
    drone.on_matched({{"left", "*/*", "anything"}, {"right", "*/*", "anything"}}, hive::Match::exact(),
                     [&](const std::vector<hive::Event>& events) {
                         set.emit({{"index", events.at(0).header.value("index", std::int64_t{0})}});
                     });
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv,
                           {.kind = "pair", .summary = "Joins the events of two inputs, for tests.", .stateful = true},
                           pair_drone);
}
