// Collects samples into families. Equal labels of one family are one sample.
#pragma once

#include <hive/metrics.hpp>

#include <map>

namespace hive::measuring {

using Labels = std::vector<std::pair<std::string, std::string>>;

/// Name and meaning of a family, without its samples.
struct Described {
    const char* name;
    MetricFamily::Type type;
    const char* unit;
    const char* help;
    bool largest = false;  ///< samples with equal labels: keep the largest instead of the sum
};

class Book {
public:
    void add(const Described& family, const Labels& labels, double value, std::int64_t created_us = 0);
    void add_us(const Described& family, const Labels& labels, std::int64_t us, std::int64_t created_us = 0)
    {
        add(family, labels, static_cast<double>(us) / 1e6, created_us);
    }
    /// In the order of their first samples.
    [[nodiscard]] Metrics take() { return std::move(families_); }

private:
    Metrics families_;
    std::map<std::string_view, std::size_t> numbers_;        ///< of families, by name
    std::vector<std::map<Labels, std::size_t>> of_samples_;  ///< by family and labels
};

}  // namespace hive::measuring
