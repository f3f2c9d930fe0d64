// The write drone writes the images that it receives to a video or a folder.
#include "write_drone.hpp"

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv,
                           {.kind = "write", .summary = "Writes images to a video file or a folder.", .stateful = true},
                           [](hive::Drone& drone) { writing::WriteDrone(drone).run(); });
}
