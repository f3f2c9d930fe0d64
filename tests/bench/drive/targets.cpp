// The targets: a ratio of two rows of one column, or what one takes more than the other, and what it has to be.
#include "report.hpp"

#include "table.hpp"

#include <cstdio>
#include <iostream>

namespace hive::bench {
namespace {

enum class Bound { at_most, at_least };

struct Target {
    std::string what;
    Row row;
    Row against;  ///< empty: the value itself
    std::string column;
    std::string key;
    Bound bound;
    double value;
    bool more = false;  ///< how much more than the other row, not how many times as much
};

using enum Bound;

std::vector<Target> latency_targets()
{
    return {
        {"latency 64 B, shared memory", "hive/local", "raw_shm/copy", "lat64", "p50", at_most, 1.6},
        {"latency 64 B, shared memory", "hive/local", "iceoryx/loan", "lat64", "p50", at_most, 0.75},
        {"latency 100 KB, shared memory", "hive/local", "raw_shm/copy", "lat100K", "p50", at_most, 1.4},
        {"latency 2.76 MB, copied in", "hive/local", "raw_shm/copy", "lat2.8M", "p50", at_most, 1.1},
        {"latency 6.22 MB, copied in", "hive/local", "raw_shm/copy", "lat6.2M", "p50", at_most, 1.1},
        {"latency 6.22 MB, produced in place", "hive/local-zc", "raw_shm/zc", "lat6.2M", "p50", at_most, 1.2},
        {"latency 64 B, TCP", "hive/tcp", "raw_sock/tcp-direct-b256", "lat64", "p50", at_most, 1.2},
        {"latency 64 B, TCP", "hive/tcp", "zmq/tcp", "lat64", "p50", at_most, 0.5},
        {"latency 64 B, TCP", "hive/tcp", "nng/tcp", "lat64", "p50", at_most, 0.5},
        {"latency 100 KB, TCP", "hive/tcp", "raw_sock/tcp-direct-b256", "lat100K", "p50", at_most, 1.2},
        {"latency 100 KB, TCP", "hive/tcp", "zmq/tcp", "lat100K", "p50", at_most, 0.5},
        {"latency 100 KB, TCP", "hive/tcp", "nng/tcp", "lat100K", "p50", at_most, 0.5},
        {"latency 6.22 MB, TCP", "hive/tcp", "raw_sock/tcp-direct-b256", "lat6.2M", "p50", at_most, 1.15},
        {"p99 64 B, shared memory", "hive/local", "raw_shm/copy", "lat64", "p99", at_most, 1.3},
        {"p99 100 KB, shared memory", "hive/local", "raw_shm/copy", "lat100K", "p99", at_most, 1.3},
        {"p99 6.22 MB, copied in", "hive/local", "raw_shm/copy", "lat6.2M", "p99", at_most, 1.3},
        {"p99 6.22 MB, produced in place", "hive/local-zc", "raw_shm/zc", "lat6.2M", "p99", at_most, 1.3},
        {"p99 64 B, TCP", "hive/tcp", "raw_sock/tcp-direct-b256", "lat64", "p99", at_most, 1.3},
        {"p99 100 KB, TCP", "hive/tcp", "raw_sock/tcp-direct-b256", "lat100K", "p99", at_most, 1.3},
        {"p99 6.22 MB, TCP", "hive/tcp", "raw_sock/tcp-direct-b256", "lat6.2M", "p99", at_most, 1.3},
    };
}

std::vector<Target> throughput_targets()
{
    return {
        {"throughput 100 KB, shared memory", "hive/local", "raw_shm/copy", "thr100K", "per_second", at_least, 0.75},
        {"throughput 6.22 MB, shared memory", "hive/local", "raw_shm/copy", "thr6.2M", "per_second", at_least, 0.9},
        {"throughput 100 KB, TCP", "hive/tcp", "raw_sock/tcp-direct-b256", "thr100K", "per_second", at_least, 0.85},
        {"throughput 100 KB, TCP", "hive/tcp", "zmq/tcp", "thr100K", "per_second", at_least, 1.7},
        {"throughput 6.22 MB, TCP", "hive/tcp", "raw_sock/tcp-direct-b256", "thr6.2M", "per_second", at_least, 0.85},
        {"throughput 6.22 MB, TCP", "hive/tcp", "asio/tcp", "thr6.2M", "per_second", at_least, 1.2},
        {"throughput 6.22 MB, TCP", "hive/tcp", "zmq/tcp", "thr6.2M", "per_second", at_least, 1.2},
        {"throughput 6.22 MB, TCP", "hive/tcp", "nng/tcp", "thr6.2M", "per_second", at_least, 1.2},
        {"fan-out 1 -> 4, shared memory: CPU", "hive/local", "raw_shm/copy", "fan4", "cpu", at_most, 1.1},
        {"fan-out 1 -> 4, shared memory: CPU", "hive/local", "iceoryx/loan", "fan4", "cpu", at_most, 0.7},
        {"fan-out 1 -> 4, shared memory: rate", "hive/local", "raw_shm/copy", "fan4", "per_second", at_least, 0.9},
        {"fan-out 1 -> 4, same host: CPU seconds for 1000", "hive/local", "", "fan4", "cpu", at_most, 1.2},
        {"fan-out 1 -> 4, TCP: CPU", "hive/tcp", "raw_sock/tcp-direct-b256", "fan4", "cpu", at_most, 1.15},
    };
}

std::vector<Target> round_trip_targets()
{
    return {
        {"RPC 64 B, TCP", "hive/tcp", "raw_sock/tcp", "rpc64", "p50", at_most, 1.15},
        {"RPC 64 B, TCP", "hive/tcp", "zmq/tcp", "rpc64", "p50", at_most, 0.8},
        {"RPC 64 B, same host", "hive/local", "raw_shm/copy", "rpc64", "p50", at_most, 1.2},
        {"RPC 64 B, one core busy", "hive/tcp", "raw_sock/tcp", "rpc64-busy", "per_second", at_least, 0.8},
        {"sync 100 KB, TCP, one core busy", "hive/tcp", "raw_sock/tcp", "sync100K-busy", "per_second", at_least, 0.8},
        {"sync 100 KB, TCP", "hive/tcp", "raw_sock/tcp", "sync100K", "per_second", at_least, 0.9},
        {"sync 100 KB, TCP", "hive/tcp", "zmq/tcp", "sync100K", "per_second", at_least, 1.5},
        {"sync 100 KB, TCP", "hive/tcp", "nng/tcp", "sync100K", "per_second", at_least, 2.0},
        {"sync 100 KB, TCP, prefetch", "hive/tcp", "raw_sock/tcp-prefetch-b256", "prefetch100K", "per_second", at_least,
         0.8},
        {"sync 6.22 MB, TCP", "hive/tcp", "raw_sock/tcp-direct-b256", "sync6.2M", "per_second", at_least, 0.88},
        {"sync 6.22 MB, TCP", "hive/tcp", "asio/tcp", "sync6.2M", "per_second", at_least, 1.5},
        {"sync 6.22 MB, shared memory", "hive/local", "raw_shm/copy", "sync6.2M", "per_second", at_least, 0.9},
    };
}

std::vector<Target> key_targets()
{
    return {
        {"throughput 6.22 MB, TLS: GB/s", "hive/tls", "", "thr6.2M", "gigabytes_per_second", at_least, 1.0},
        {"sync 100 KB, TLS", "hive/tls", "hive/tcp", "sync100K", "per_second", at_least, 0.45},
        {"handshake: us more to connect", "hive/tls", "hive/tcp", "dial64", "p50", at_most, 1000, true},
    };
}

std::optional<Figure> quotient(const std::optional<Figure>& above, const std::optional<Figure>& below)
{
    if (!above || !below || below->value <= 0)
        return std::nullopt;
    return Figure{above->value / below->value, std::min(above->runs, below->runs),
                  above->disturbed || below->disturbed};
}

std::optional<Figure> difference(const std::optional<Figure>& row, const std::optional<Figure>& against)
{
    if (!row || !against)
        return std::nullopt;
    return Figure{row->value - against->value, std::min(row->runs, against->runs),
                  row->disturbed || against->disturbed};
}

std::optional<Figure> measured(const Records& records, const Target& target)
{
    if (target.against.empty())
        return records.value(target.row, target.column, target.key);
    if (target.more)
        return difference(records.value(target.row, target.column, target.key),
                          records.value(target.against, target.column, target.key));
    if (target.key == "p99")  // of all samples together: that of a single run is its slowest frame
        return quotient(records.p99(target.row, target.column), records.p99(target.against, target.column));
    return records.ratio(target.row, target.against, target.column, target.key);
}

Cells line(const std::string& what, const std::string& rows, const std::optional<Figure>& figure, Bound bound,
           double value)
{
    char wanted[32];
    std::snprintf(wanted, sizeof wanted, "%s %.2f", bound == at_most ? "<=" : ">=", value);
    if (!figure)
        return {what, rows, wanted, "-", "-", "not measured"};
    const bool met = bound == at_most ? figure->value <= value : figure->value >= value;
    return {what,
            rows,
            wanted,
            ratio_text(figure),
            std::to_string(figure->runs),
            std::string(met ? "met" : "missed") + (figure->disturbed ? "*" : "")};
}

Cells line(const Target& target, const std::optional<Figure>& figure)
{
    return line(target.what,
                target.row + (target.against.empty() ? "" : (target.more ? " - " : " / ") + target.against), figure,
                target.bound, target.value);
}

void add_worker_targets(const Json& workers, std::vector<Cells>& lines)
{
    if (workers.is_null())
        return;
    const auto runs = workers.at("rounds").get<std::size_t>();
    const auto figure = [&](const Json& value) { return Figure{value.get<double>(), runs}; };
    lines.push_back(
        line("one face worker", "Hive / bare OpenCV", figure(workers.at("hive_to_bare").at(0)), at_least, 0.97));
    lines.push_back(
        line("two face workers", "Hive / bare OpenCV", figure(workers.at("hive_to_bare").at(1)), at_least, 0.97));
    lines.push_back(line("two face workers: gain", "two / one", figure(workers.at("gain")), at_least, 1.9));
}

}  // namespace

void print_targets(const Records& records)
{
    std::vector<Cells> lines;
    for (const auto& targets : {latency_targets(), throughput_targets(), round_trip_targets(), key_targets()})
        for (const auto& target : targets)
            if (records.has({}, target.column))
                lines.push_back(line(target, measured(records, target)));
    add_worker_targets(records.workers(), lines);
    std::cout << "\nTargets: the median of the ratios of runs that are neighbours in time.\n\n";
    print_table({"target", "rows", "wanted", "measured", "pairs", ""}, lines);
}

}  // namespace hive::bench
