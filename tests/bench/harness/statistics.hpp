// Medians and percentiles.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace hive::bench {

/// Between neighbours by proportion; `values` must not be empty. @param part  0 to 1
inline double percentile(std::vector<double> values, double part)
{
    std::sort(values.begin(), values.end());
    const double place = part * static_cast<double>(values.size() - 1);
    const auto low = static_cast<std::size_t>(place);
    const auto high = std::min(low + 1, values.size() - 1);
    const double share = place - static_cast<double>(low);
    return values[low] * (1 - share) + values[high] * share;
}

inline double median(std::vector<double> values) { return percentile(std::move(values), 0.5); }

}  // namespace hive::bench
