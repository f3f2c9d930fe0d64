// Comparing with the most of the first looks.
#include "growth.hpp"

#include <algorithm>

namespace hive::soak {
namespace {

constexpr int first_looks = 3;
/// Allocators keep what was freed, and connections come and go.
constexpr std::int64_t more_memory = 24 << 20, more_descriptors = 16;

}  // namespace

mixtures::Problems Growth::look(const Usages& usages)
{
    mixtures::Problems problems;
    const auto require = [&](const std::string& drone, std::int64_t now, std::int64_t first, std::int64_t more,
                             const char* what) {
        if (now > first + more)
            problems.push_back("growth: " + drone + " has " + std::to_string(now) + " " + what + "; it had "
                               + std::to_string(first));
    };
    for (const auto& [drone, usage] : usages) {
        auto& row = rows_[drone];
        if (row.looks++ < first_looks) {
            row.most.memory = std::max(row.most.memory, usage.memory);
            row.most.descriptors = std::max(row.most.descriptors, usage.descriptors);
            continue;
        }
        require(drone, usage.memory, row.most.memory, more_memory, "bytes of memory");
        require(drone, usage.descriptors, row.most.descriptors, more_descriptors, "descriptors");
    }
    return problems;
}

}  // namespace hive::soak
