// Compares and mixes histograms.
#include "look.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace track {

Look look_of(const std::vector<double>& numbers)
{
    const double sum = std::accumulate(numbers.begin(), numbers.end(), 0.0);
    Look look;
    if (sum > 0)
        for (const double number : numbers)
            look.push_back(static_cast<float>(number / sum));
    return look;
}

std::optional<double> difference(const Look& a, const Look& b)
{
    if (a.empty() || a.size() != b.size())
        return std::nullopt;
    double common = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        common += std::sqrt(static_cast<double>(a[i]) * static_cast<double>(b[i]));
    return std::sqrt(std::max(0.0, 1 - common));
}

void follow(Look& look, const Look& seen, double share)
{
    if (look.size() != seen.size()) {
        look = look.empty() ? seen : look;
        return;
    }
    for (std::size_t i = 0; i < look.size(); ++i)
        look[i] += static_cast<float>(share) * (seen[i] - look[i]);
}

}  // namespace track
