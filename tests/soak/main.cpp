// The command line of a soak.
#include "soak.hpp"

#include <CLI/CLI.hpp>

#include <csignal>
#include <iostream>
#include <random>

namespace {

volatile std::sig_atomic_t interrupted = 0;

constexpr int exit_not_possible = 77;  // CTest shows it as skipped

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Runs a swarm on three machines (network namespaces) under faults drawn from a seed, and stops at the "
                 "first broken promise. tests/soak/README.md says what is checked.",
                 "scripts/soak");
    hive::soak::Options options;
    options.seed = std::random_device()();
    int seconds = 600;
    double fault_every = 10;
    app.add_option("--seconds", seconds, "no fault after that")->capture_default_str()->check(CLI::PositiveNumber);
    app.add_option("--seed", options.seed, "draw the same faults again; default: random");
    app.add_option("--fault-every", fault_every, "seconds from one fault to the next, at least")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    app.add_flag("--plant-loss", options.plant_loss, "make a drone swallow results, which must be found");
    CLI11_PARSE(app, argc, argv);
    options.time = std::chrono::seconds(seconds);
    options.fault_every = std::chrono::duration<double>(fault_every);
    if (const auto missing = hive::test::missing_for_lab(); !missing.empty()) {
        std::cerr << "skipped: soak needs " << missing << std::endl;
        return exit_not_possible;
    }
    struct sigaction action {};
    action.sa_handler = [](int) { interrupted = 1; };
    ::sigaction(SIGINT, &action, nullptr);
    ::sigaction(SIGTERM, &action, nullptr);
    options.interrupted = [] { return interrupted != 0; };
    try {
        return hive::soak::Soak(options, std::cout).run();
    } catch (const std::exception& error) {
        std::cerr << "soak: the swarm did not start: " << error.what() << std::endl;
        return interrupted != 0 ? 0 : 1;
    }
}
