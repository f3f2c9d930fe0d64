// The record drone writes every event that it receives to one file.
#include "record_drone.hpp"

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {.kind = "record", .summary = "Records events into a file.", .stateful = true},
                           [](hive::Drone& drone) { record::RecordDrone(drone).run(); });
}
