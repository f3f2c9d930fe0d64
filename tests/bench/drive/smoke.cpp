// Everything for a moment: what a test can say of a benchmark without measuring time.
#include "driver.hpp"

#include "job.hpp"

#include <iostream>

namespace hive::bench {
namespace {

const std::vector<Column>& few()
{
    static const std::vector<Column> all{
        {.name = "lat", .test = Test::latency, .size = 64, .pairs = {}, .once = {}},
        {.name = "thr", .test = Test::throughput, .size = 100'000, .pairs = {}, .once = {}},
        {.name = "large", .test = Test::throughput, .size = 1'500'000, .subscribers = 4, .pairs = {}, .once = {}},
        {.name = "sync", .test = Test::sync, .size = 100'000, .window = 1, .pairs = {}, .once = {}},
        {.name = "prefetch", .test = Test::sync, .size = 100'000, .window = 2, .pairs = {}, .once = {}},
        {.name = "rpc", .test = Test::rpc, .size = 64, .pairs = {}, .once = {}},
        {.name = "dial", .test = Test::rpc, .size = 64, .dial = true, .pairs = {}, .once = {}},
    };
    return all;
}

/// Were all frames received, and whole?
bool try_row(const Row& row, const Column& column)
{
    Run run = run_of(row, column);
    run.frames = 6;
    run.rate = 200;
    run.seconds = 0.01;
    const auto outcome = execute(run).value_or(Json::object());
    const bool good = outcome.value("whole", false) && outcome.value("received", 0) > 0;
    std::cout << (good ? "ok      " : "FAILED  ") << row << ' ' << column.name << ": " << outcome.value("received", 0)
              << " received, " << outcome.value("lost", -1) << " lost, " << outcome.value("bad", -1) << " bad\n";
    return good;
}

/// Hive in all, a connection for each question only where there are connections; for the limits sync, prefetch and rpc
/// are the same code.
bool worth_trying(const Row& row, const Column& column)
{
    if (column.dial)
        return row == "hive/tcp" || row == "hive/tls";
    return row.starts_with("hive/") || (row.starts_with("raw_") && column.name != "prefetch" && column.name != "rpc");
}

}  // namespace

bool smoke()
{
    bool well = true;
    for (const auto& row : rows())
        for (const auto& column : few())
            if (worth_trying(row, column))
                well = try_row(row, column) && well;
    return well;
}

}  // namespace hive::bench
