// The command line of a soak.
#include "soak.hpp"

#include <CLI/CLI.hpp>

#include <csignal>
#include <iostream>
#include <random>

#include <unistd.h>

namespace {

volatile std::sig_atomic_t interrupted = 0, late = 0;

constexpr unsigned grace_s = 300;  // for the start, the last rest and the end; the TIMEOUT of CTest is later

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
    action.sa_handler = [](int) {
        late = 1;
        interrupted = 1;
    };
    ::sigaction(SIGALRM, &action, nullptr);
    ::alarm(static_cast<unsigned>(seconds) + grace_s);  // so that no drone, namespace or sshd stays
    options.interrupted = [] { return interrupted != 0; };
    int code = 1;
    try {
        code = hive::soak::Soak(options, std::cout).run();
    } catch (const std::exception& error) {
        std::cerr << "soak: the swarm did not start: " << error.what() << std::endl;
        code = interrupted != 0 ? 0 : 1;
    }
    if (late == 0)
        return code;
    std::cerr << "soak: not done " << grace_s << " s after its time" << std::endl;
    return 1;
}
