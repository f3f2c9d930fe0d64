// The view drone shows images in a window and in browsers.
#include "view_drone.hpp"

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"view", "Shows images in a window and in browsers."},
                           [](hive::Drone& drone) { view::ViewDrone(drone).run(); });
}
