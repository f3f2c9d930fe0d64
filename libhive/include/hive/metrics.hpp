// The counters of a swarm for Prometheus: families of samples, and the two text formats for scraping them.
#pragma once

#include <hive/application.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hive {

/// One number of a family, identified by its labels.
struct MetricSample {
    std::vector<std::pair<std::string, std::string>> labels{};
    double value = 0;
    std::int64_t created_us = 0;  ///< of a counter: wall clock at which it was 0; 0: not known
};

struct MetricFamily {
    /// A state has one sample per possible state, of which one is 1; its last label has the name of the family.
    enum class Type { counter, gauge, info, state };
    std::string name;  ///< "hive_drone_busy_seconds", without the "_total" or "_info" of its samples
    Type type{};
    std::string unit{};  ///< "seconds": the suffix of the name; empty: a plain number
    std::string help{};  ///< one sentence
    std::vector<MetricSample> samples{};
};

/// No two families of one name, and no two samples of a family with equal labels.
using Metrics = std::vector<MetricFamily>;

/// Queries all drones at once; the counters of one drone are of one instant. A drone that does not answer is counted,
/// and is not an error. Waits at most the application's timeout.
Metrics metrics(Application& application);
/// The same from answers at hand.
/// @param crashed  drones that crashed and are not running
Metrics metrics(const std::vector<StatusAnswer>& answers, const std::vector<std::string>& crashed = {});

/// The Prometheus text format 0.0.4, or OpenMetrics 1.0.0.
enum class MetricsForm { prometheus, openmetrics };
std::string to_text(const Metrics& metrics, MetricsForm form);
/// [{"name", "type": "counter", "unit", "help", "samples": [{"labels": {}, "value", "created_us"}]}]; empty and unknown
/// fields are omitted.
Json to_json(const Metrics& metrics);
/// The media type for HTTP. Prometheus 3 refuses any other.
std::string_view media_type(MetricsForm form) noexcept;
/// The format that a scraper prefers.
/// @param accept  the header Accept of its request
MetricsForm metrics_form(std::string_view accept);

}  // namespace hive
