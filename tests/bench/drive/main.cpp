// bench_drive: measures, reports, or tries everything for a moment.
//
//     bench_drive run [options]   measures, and writes a line of JSON for each run
//     bench_drive report FILE     prints the tables of such a file
//     bench_drive smoke           a few frames through Hive and the limits; exit code 1 when any was lost or corrupt
#include "driver.hpp"
#include "report.hpp"

#include <CLI/CLI.hpp>

#include <iostream>

namespace {

using namespace hive::bench;

CLI::App* add_run(CLI::App& app, DriveOptions& options)
{
    auto* run = app.add_subcommand("run", "measure");
    run->add_option("--out", options.out, "where the JSON goes; an older file is replaced")->capture_default_str();
    run->add_option("--only", options.only, "rows: a regular expression, as in 'local|raw_shm'")->capture_default_str();
    run->add_option("--column", options.column, "columns: a regular expression, as in lat64")->capture_default_str();
    run->add_option("--rounds", options.rounds, "rounds of everything")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    run->add_option("--laps", options.laps, "pairs of Hive and limit in each round")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    run->add_option("--budget", options.budget, "seconds; what is not run by then is left out")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    run->add_option("--frames", options.frames, "of each latency run")
        ->check(CLI::Range(2, 10000))
        ->capture_default_str();
    run->add_option("--seconds", options.seconds, "of each other run")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    return run;
}

void print_all(const std::string& file)
{
    const Records records(file);
    print_report(records);
    print_targets(records);
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Hive beside its peers and the machine's limits.", "bench_drive");
    app.require_subcommand(1);
    DriveOptions options;
    const auto* run = add_run(app, options);
    auto* report = app.add_subcommand("report", "print the tables");
    std::string file;
    report->add_option("file", file, "what `run` wrote")->required();
    const auto* short_run = app.add_subcommand("smoke", "try everything for a moment");
    CLI11_PARSE(app, argc, argv);
    try {
        if (run->parsed())
            drive(options);
        if (report->parsed())
            print_all(file);
        return short_run->parsed() && !smoke() ? 1 : 0;
    } catch (const std::exception& error) {
        std::cerr << "bench_drive: " << error.what() << '\n';
        return 1;
    }
}
