// Rounds on real drones.
#include "rounds.hpp"
#include "running.hpp"

int main(int argc, char** argv)
{
    CLI::App app(
        "Plays seeded mixtures of connects, kills, halts, sets and more on real swarms, and checks what was promised.",
        "mixtures");
    return hive::mixtures::play_rounds(app, argc, argv, hive::mixtures::play);
}
