// Starting a row's program.
#include "job.hpp"

#include "process.hpp"

#include <iostream>
#include <unistd.h>

namespace hive::bench {
namespace fs = std::filesystem;

namespace {

fs::path program_of(const std::string& program) { return programs() / ("bench_" + program); }

}  // namespace

fs::path programs() { return fs::read_symlink("/proc/self/exe").parent_path(); }

bool present(const Row& row) { return fs::exists(program_of(row.substr(0, row.find('/')))); }

Run run_of(const Row& row, const Column& column)
{
    Run run;
    run.program = row.substr(0, row.find('/'));
    run.variant = row.substr(row.find('/') + 1);
    run.test = column.test;
    run.size = column.size;
    run.subscribers = column.subscribers;
    run.window = column.window;
    run.busy = column.busy;
    run.dial = column.dial;
    return run;
}

std::optional<Json> execute(const Run& run)
{
    const auto stem = "/tmp/hive-bench-drive-" + std::to_string(::getpid());
    auto words = words_of(run);
    words.insert(words.begin(), program_of(run.program).string());
    test::Process process(words, {}, stem + ".out", stem + ".err");
    process.wait(test::Milliseconds(static_cast<std::int64_t>((run.timeout + 10) * 1000)));
    process.kill();
    const auto line = test::text_of(stem + ".out"), errors = test::text_of(stem + ".err");
    fs::remove(stem + ".out");
    fs::remove(stem + ".err");
    std::cerr << errors;
    const Json outcome = Json::parse(line, nullptr, false);
    return outcome.is_object() ? std::optional(outcome) : std::nullopt;
}

}  // namespace hive::bench
