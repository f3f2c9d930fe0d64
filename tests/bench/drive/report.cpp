// The tables of the report.
#include "report.hpp"

#include "table.hpp"

#include <algorithm>
#include <iostream>

namespace hive::bench {
namespace {

using Strings = std::vector<std::string>;

class Report {
public:
    explicit Report(const Records& records) : records_(records) {}

    void latency() const
    {
        const Strings columns{"lat64", "lat100K", "lat2.8M", "lat6.2M"};
        table({"One-way latency at 60 Hz, from before the copy until every line was touched, us: p50 / p99.\n"
               "avail: until the frame could be read. xL: p50 over that of the limit.",
               columns,
               {"row", "64 B", "xL", "100 KB", "xL", "2.76 MB", "xL", "6.22 MB", "xL", "avail"}},
              [&](const Row& row) {
                  Cells cells;
                  for (const auto& column : columns)
                      add(cells,
                          {pair_text(value(row, column, "p50"), records_.p99(row, column)), ratio(row, column, "p50")});
                  add(cells, {text_of(value(row, "lat6.2M", "available_p50"))});
                  return cells;
              });
    }

    void throughput() const
    {
        table({"Throughput 1 -> 1 and fan-out 1 -> 4 (frames a second that each of the four gets), nothing lost. frac: "
               "of the limit's rate.\n"
               "CPU: seconds for 1000 frames, publisher and subscribers; xL: over the limit's. switches: times a "
               "thread went to sleep, for one frame.",
               {"thr100K", "thr6.2M", "fan4"},
               {"row", "100KB f/s", "GB/s", "frac", "switches", "6.22MB f/s", "GB/s", "frac", "switches", "CPU",
                "1->4 f/s", "frac", "CPU", "xL", "pub CPU", "60Hz CPU"}},
              [&](const Row& row) {
                  Cells cells = rate(row, "thr100K");
                  add(cells, rate(row, "thr6.2M"));
                  add(cells,
                      {text_of(value(row, "thr6.2M", "cpu")), text_of(value(row, "fan4", "per_second")),
                       ratio(row, "fan4", "per_second"), text_of(value(row, "fan4", "cpu")), ratio(row, "fan4", "cpu"),
                       text_of(value(row, "fan4", "publisher_cpu")), text_of(value(row, "lat6.2M", "cpu"))});
                  return cells;
              });
    }

    void round_trips() const
    {
        table({"RPC of 64 B, and one request for each frame: us p50 / p99 of the round trip, and a second. frac: of "
               "the limit's rate.\n"
               "prefetch: two requests under way.",
               {"rpc64", "sync100K", "prefetch100K", "sync6.2M"},
               {"row", "RPC", "/s", "frac", "100 KB", "f/s", "frac", "prefetch f/s", "frac", "6.22 MB", "f/s", "frac"}},
              [&](const Row& row) {
                  Cells cells = round_trip(row, "rpc64");
                  add(cells, round_trip(row, "sync100K"));
                  add(cells,
                      {text_of(value(row, "prefetch100K", "per_second")), ratio(row, "prefetch100K", "per_second")});
                  add(cells, round_trip(row, "sync6.2M"));
                  return cells;
              });
    }

    void busy_core() const
    {
        table({"The same while other work takes one core.",
               {"rpc64-busy", "sync100K-busy"},
               {"row", "RPC", "/s", "frac", "100 KB", "f/s", "frac"}},
              [&](const Row& row) {
                  Cells cells = round_trip(row, "rpc64-busy");
                  add(cells, round_trip(row, "sync100K-busy"));
                  return cells;
              });
    }

    void under_key() const
    {
        table({"Under a swarm key (TLS 1.3), and the same without. CPU: seconds for 1000 frames. connect: a new "
               "caller, its\n"
               "connection with the handshake, and one RPC: us p50 / p99.",
               {"dial64"},
               {"row", "6.22 MB GB/s", "CPU", "sync 100 KB f/s", "connect"}},
              [&](const Row& row) {
                  return Cells{text_of(value(row, "thr6.2M", "gigabytes_per_second")),
                               text_of(value(row, "thr6.2M", "cpu")), text_of(value(row, "sync100K", "per_second")),
                               pair_text(value(row, "dial64", "p50"), value(row, "dial64", "p99"))};
              });
    }

    void failures() const
    {
        for (const auto* run : records_.failed())
            std::cout << "FAILED " << run->at("row").get<std::string>() << ' ' << run->at("column").get<std::string>()
                      << ": lost " << run->value("lost", -1) << ", bad " << run->value("bad", -1) << '\n';
        std::cout << '\n'
                  << records_.size() << " runs, " << records_.failed().size() << " failed; " << records_.disturbed()
                  << " disturbed: others used more than a quarter of a core (*: figures that rest on such runs)\n";
    }

private:
    static void add(Cells& cells, const Cells& more) { cells.insert(cells.end(), more.begin(), more.end()); }

    struct Shape {
        std::string title;
        Strings columns;  ///< of the measurements; a row is shown when it was in one of them
        Cells head;
    };
    template <class CellsOf>
    void table(const Shape& shape, CellsOf cells_of) const
    {
        std::vector<Cells> lines;
        for (const auto& row : rows())
            if (std::any_of(shape.columns.begin(), shape.columns.end(),
                            [&](const auto& column) { return records_.has(row, column); })) {
                Cells cells{row};
                add(cells, cells_of(row));
                lines.push_back(std::move(cells));
            }
        if (lines.empty())
            return;
        std::cout << '\n' << shape.title << "\n\n";
        print_table(shape.head, lines);
    }

    [[nodiscard]] std::optional<Figure> value(const Row& row, const std::string& column, const char* key) const
    {
        return records_.value(row, column, key);
    }
    [[nodiscard]] std::string ratio(const Row& row, const std::string& column, const char* key) const
    {
        return ratio_text(records_.ratio(row, limit_of(row, column), column, key));
    }
    [[nodiscard]] Cells rate(const Row& row, const std::string& column) const
    {
        return {text_of(value(row, column, "per_second")), text_of(value(row, column, "gigabytes_per_second")),
                ratio(row, column, "per_second"), text_of(value(row, column, "switches"))};
    }
    [[nodiscard]] Cells round_trip(const Row& row, const std::string& column) const
    {
        return {pair_text(value(row, column, "p50"), value(row, column, "p99")),
                text_of(value(row, column, "per_second")), ratio(row, column, "per_second")};
    }

    const Records& records_;
};

}  // namespace

void print_report(const Records& records)
{
    const Report report(records);
    report.latency();
    report.throughput();
    report.round_trips();
    report.busy_core();
    report.under_key();
    report.failures();
}

}  // namespace hive::bench
