// Plays rounds in the simulated world.
#include "simulation.hpp"

#include <rounds.hpp>

#include <iomanip>
#include <iostream>

int main(int argc, char** argv)
{
    using Seconds = std::chrono::duration<double>;
    CLI::App app("Plays seeded mixtures of connects, kills, halts, sets and more on swarms in a simulated world, and "
                 "checks what was promised.",
                 "scripts/simulate");
    bool trace = false;
    app.add_flag("--trace", trace, "print what happens, a line each");
    const auto begin = std::chrono::steady_clock::now();
    std::uint64_t histories = 0, handlers = 0;
    Seconds simulated{};
    const auto play = [&](const hive::mixtures::Plan& plan) {
        auto played = hive::simulation::play(plan, trace);
        ++histories;
        handlers += played.handlers;
        simulated += played.time;
        if (trace)
            std::cout << "digest " << std::hex << played.digest << std::dec << "\n";
        return played;
    };
    const int code = hive::mixtures::play_rounds(app, argc, argv, play, hive::mixtures::fault::all);
    const Seconds took = std::chrono::steady_clock::now() - begin;
    std::cout << std::fixed << std::setprecision(0) << "a second: " << static_cast<double>(histories) / took.count()
              << " histories, " << simulated / took << " simulated seconds, "
              << static_cast<double>(handlers) / took.count() << " handlers\n";
    return code;
}
