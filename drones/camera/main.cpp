// The camera drone publishes images from a scene, files, devices and network cameras, live or on demand.
#include "camera_drone.hpp"

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv,
                           {"camera", "Publishes images from a camera, from files, or of a synthetic scene."},
                           [](hive::Drone& drone) { camera::CameraDrone(drone).run(); });
}
