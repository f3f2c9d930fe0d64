// The axis drone publishes images from an Axis network camera, live or on demand.
#include "axis_drone.hpp"

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"axis", "Publishes images from an Axis network camera."},
                           [](hive::Drone& drone) { axis::AxisDrone(drone).run(); });
}
