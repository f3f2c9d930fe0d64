// The replay drone publishes a recording on the outputs that were recorded.
#include "replay_drone.hpp"

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"replay", "Replays the events of a recording unchanged."},
                           [](hive::Drone& drone) { replay::ReplayDrone(drone).run(); });
}
