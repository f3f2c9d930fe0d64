// Summing up the board.
#include "outcome.hpp"

#include "statistics.hpp"

#include <cmath>

namespace hive::bench {
namespace {

using Samples = std::array<float, most_samples>;

double rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit; }

struct Sum {
    std::uint64_t frames = 0, bad = 0, least = ~std::uint64_t{0};
    std::int64_t lost = 0;
    Usage usage;
    double rate = 0;  ///< of the slowest
    std::vector<double> available, touched;
};

double rate_of(const Received& received, bool round_trips)
{
    const auto time = seconds_of(received.last - received.first);
    const auto steps = received.frames - (round_trips ? 0 : 1);
    return received.frames > 1 && time > 0 ? static_cast<double>(steps) / time : 0;
}

void add(Sum& sum, const Received& received, std::uint64_t sent, bool round_trips)
{
    sum.frames += received.frames;
    sum.least = std::min(sum.least, received.frames);
    sum.bad += received.bad;
    sum.lost += std::max<std::int64_t>(0, static_cast<std::int64_t>(sent) - static_cast<std::int64_t>(received.frames));
    sum.usage.cpu += received.usage.cpu;
    sum.usage.voluntary_switches += received.usage.voluntary_switches;
    sum.usage.page_faults += received.usage.page_faults;
    sum.available.insert(sum.available.end(), received.available.begin(),
                         received.available.begin() + received.samples);
    sum.touched.insert(sum.touched.end(), received.touched.begin(), received.touched.begin() + received.samples);
    const double rate = rate_of(received, round_trips);
    sum.rate = sum.rate == 0 ? rate : std::min(sum.rate, rate);
}

Json identity(const Run& run)
{
    return {{"program", run.program},         {"variant", run.variant}, {"test", to_text(run.test)}, {"size", run.size},
            {"subscribers", run.subscribers}, {"window", run.window},   {"busy", run.busy}};
}

}  // namespace

Json outcome_of(const Run& run, const Board& board, bool complete)
{
    Sum sum;
    const bool round_trips = board.serving;
    for (int i = 0; i < run.subscribers; ++i)
        add(sum, board.received[static_cast<std::size_t>(i)], board.sent, round_trips);
    Json json = identity(run);
    const bool any = sum.least > 0 && !sum.touched.empty();
    const bool whole = complete && board.finished && any && sum.bad == 0 && sum.lost == 0;
    json["whole"] = whole;
    json["ok"] = whole && board.stalls == 0;
    json.update({{"sent", board.sent},
                 {"received", sum.frames},
                 {"lost", sum.lost},
                 {"bad", sum.bad},
                 {"stalls", board.stalls}});
    if (!any)
        return json;
    const double thousand = 1000.0 / static_cast<double>(sum.least), one = 1.0 / static_cast<double>(sum.least);
    json.update(
        {{"per_second", rounded(sum.rate, 100)},
         {"gigabytes_per_second", rounded(sum.rate * static_cast<double>(run.size) * 1e-9, 1e4)},
         {"publisher_cpu", rounded(board.usage.cpu * thousand, 1e4)},
         {"cpu", rounded((board.usage.cpu + sum.usage.cpu) * thousand, 1e4)},
         {"switches",
          rounded(static_cast<double>(board.usage.voluntary_switches + sum.usage.voluntary_switches) * one, 100)},
         {"faults", rounded(static_cast<double>(board.usage.page_faults + sum.usage.page_faults) * one, 100)},
         {"available_p50", rounded(median(sum.available), 100)},
         {"p50", rounded(median(sum.touched), 100)},
         {"p99", rounded(percentile(sum.touched, 0.99), 100)}});
    if (run.test == Test::latency) {
        json["samples"] = Json::array();
        for (const double sample : sum.touched)
            json["samples"].push_back(rounded(sample, 10));
    }
    return json;
}

}  // namespace hive::bench
