// Finds the sample of the labels, or makes it.
#include "book.hpp"

#include <algorithm>

namespace hive::measuring {

void Book::add(const Described& family, const Labels& labels, double value, std::int64_t created_us)
{
    const auto [number, first] = numbers_.try_emplace(family.name, families_.size());
    if (first) {
        families_.push_back({.name = family.name, .type = family.type, .unit = family.unit, .help = family.help});
        of_samples_.emplace_back();
    }
    auto& samples = families_[number->second].samples;
    const auto [index, fresh] = of_samples_[number->second].try_emplace(labels, samples.size());
    if (fresh) {
        samples.push_back({labels, value, created_us});
        return;
    }
    auto& sample = samples[index->second];
    sample.value = family.largest ? std::max(sample.value, value) : sample.value + value;
}

}  // namespace hive::measuring
