// What is measured by default.
#include "plan.hpp"

namespace hive::bench {
namespace {

constexpr std::size_t small = 64, jpeg = 100'000, hd = 2'764'800, full_hd = 6'220'800;

using Rows = std::vector<Row>;

Rows operator+(Rows left, const Rows& right)
{
    left.insert(left.end(), right.begin(), right.end());
    return left;
}

const Rows one_way{"raw_shm/copy", "hive/local", "raw_sock/tcp-direct-b256", "hive/tcp"};
const Rows in_place{"raw_shm/zc", "hive/local-zc"};
const Rows further{"raw_sock/unix-direct", "hive/tls"};
const Rows sealed{"hive/tls", "raw_sock/tcp-sealed"};
const Rows connecting{"hive/tcp", "hive/tls"};
const Rows peers{"iceoryx/loan", "zmq/ipc", "nng/ipc", "asio/tcp", "zmq/tcp", "nng/tcp"};
const Rows round_trips{"raw_shm/copy", "hive/local", "raw_sock/tcp", "hive/tcp"};
const Rows unix_round_trips{"raw_sock/unix", "hive/tls"};
const Rows direct{"raw_sock/tcp-direct-b256"};
const Rows prefetching{"hive/local", "raw_shm/copy", "raw_sock/tcp-prefetch-b256", "hive/tcp"};
const Rows with_busy_core{"iceoryx/loan", "asio/tcp", "zmq/tcp"};

std::string kind_of(const Row& row)
{
    if (row.starts_with("raw_shm") || row.starts_with("iceoryx") || row.starts_with("hive/local"))
        return "shared memory";
    return row.find("/tcp") == std::string::npos && row.find("/tls") == std::string::npos ? "unix" : "tcp";
}

}  // namespace

const std::vector<Column>& columns()
{
    static const std::vector<Column> all{
        {.name = "lat64", .test = Test::latency, .size = small, .pairs = one_way, .once = further + peers},
        {.name = "lat100K", .test = Test::latency, .size = jpeg, .pairs = one_way, .once = further + peers},
        {.name = "lat2.8M", .test = Test::latency, .size = hd, .pairs = one_way, .once = in_place + further + peers},
        {.name = "lat6.2M",
         .test = Test::latency,
         .size = full_hd,
         .pairs = one_way + in_place,
         .once = further + peers},
        {.name = "thr100K", .test = Test::throughput, .size = jpeg, .pairs = one_way, .once = further + peers},
        {.name = "thr6.2M",
         .test = Test::throughput,
         .size = full_hd,
         .pairs = one_way + Rows{"hive/tls"},
         .once = in_place + Rows{"raw_sock/unix-direct"} + peers},
        {.name = "fan4",
         .test = Test::throughput,
         .size = full_hd,
         .subscribers = 4,
         .pairs = one_way,
         .once = in_place + further + peers},
        {.name = "rpc64", .test = Test::rpc, .size = small, .pairs = round_trips, .once = unix_round_trips + peers},
        {.name = "sync100K",
         .test = Test::sync,
         .size = jpeg,
         .window = 1,
         .pairs = round_trips + sealed,
         .once = Rows{"raw_sock/unix"} + peers},
        {.name = "prefetch100K", .test = Test::sync, .size = jpeg, .window = 2, .pairs = prefetching, .once = {}},
        {.name = "sync6.2M",
         .test = Test::sync,
         .size = full_hd,
         .window = 1,
         .pairs = round_trips + direct,
         .once = unix_round_trips + peers},
        {.name = "dial64", .test = Test::rpc, .size = small, .dial = true, .pairs = connecting, .once = {}},
        {.name = "rpc64-busy",
         .test = Test::rpc,
         .size = small,
         .busy = true,
         .pairs = round_trips,
         .once = with_busy_core},
        {.name = "sync100K-busy",
         .test = Test::sync,
         .size = jpeg,
         .window = 1,
         .busy = true,
         .pairs = round_trips,
         .once = with_busy_core},
    };
    return all;
}

const std::vector<Row>& rows()
{
    static const std::vector<Row> all{"hive/local",
                                      "hive/local-zc",
                                      "hive/tcp",
                                      "hive/tls",
                                      "raw_shm/copy",
                                      "raw_shm/zc",
                                      "raw_sock/unix-direct",
                                      "raw_sock/unix",
                                      "raw_sock/tcp-direct-b256",
                                      "raw_sock/tcp",
                                      "raw_sock/tcp-prefetch-b256",
                                      "raw_sock/tcp-sealed",
                                      "iceoryx/loan",
                                      "zmq/ipc",
                                      "nng/ipc",
                                      "asio/tcp",
                                      "zmq/tcp",
                                      "nng/tcp"};
    return all;
}

Row limit_of(const Row& row, const std::string& column)
{
    const auto kind = kind_of(row);
    const bool round_trip = column.starts_with("rpc") || column.starts_with("sync") || column.starts_with("prefetch");
    if (kind == "shared memory")
        return row.ends_with("zc") ? "raw_shm/zc" : "raw_shm/copy";
    if (kind == "unix")
        return round_trip ? "raw_sock/unix" : "raw_sock/unix-direct";
    if (column == "prefetch100K")
        return "raw_sock/tcp-prefetch-b256";
    return round_trip && column != "sync6.2M" ? "raw_sock/tcp" : "raw_sock/tcp-direct-b256";
}

}  // namespace hive::bench
