// What a swarm counts, for Prometheus: families of samples, and the two text forms in which they are scraped.
#pragma once

#include <hive/application.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hive {

/// One number of a family, told from the others by its labels.
struct MetricSample {
    std::vector<std::pair<std::string, std::string>> labels{};
    double value = 0;
    std::int64_t created_us = 0;  ///< of a counter: wall clock at which it was 0; 0: not known
};

struct MetricFamily {
    /// A state has a sample for each state that there is, of which one is 1; its last label has the name of the family.
    enum class Type { counter, gauge, info, state };
    std::string name;  ///< "hive_drone_busy_seconds", without the "_total" or "_info" of its samples
    Type type{};
    std::string unit{};  ///< "seconds": the end of the name; empty: a plain number
    std::string help{};  ///< one sentence
    std::vector<MetricSample> samples{};
};

/// No two families of one name, and no two samples of a family with equal labels.
using Metrics = std::vector<MetricFamily>;

/// Asks all drones at once, each with its accounts of one moment. One that does not answer is a number, not an error.
/// Waits at most as long as the application's timeout.
Metrics metrics(Application& application);
/// The same of answers that have come.
/// @param crashed  drones that do not run, because they crashed
Metrics metrics(const std::vector<StatusAnswer>& answers, const std::vector<std::string>& crashed = {});

/// The text form 0.0.4 of Prometheus, or OpenMetrics 1.0.0.
enum class MetricsForm { prometheus, openmetrics };
std::string to_text(const Metrics& metrics, MetricsForm form);
/// [{"name", "type": "counter", "unit", "help", "samples": [{"labels": {}, "value", "created_us"}]}]; what is empty or
/// not known is left out.
Json to_json(const Metrics& metrics);
/// As HTTP needs it. Prometheus 3 refuses a scrape of another type.
std::string_view media_type(MetricsForm form) noexcept;
/// The form that a scraper prefers.
/// @param accept  the header Accept of its request
MetricsForm metrics_form(std::string_view accept);

}  // namespace hive
