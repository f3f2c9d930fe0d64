// Estimates how long nearly all of the last calls took, in a fixed amount of memory.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace hive::service {

/// A histogram of durations with eight classes per doubling, so that a class is at most 1/8 wider than its lower limit.
/// All counts are halved from time to time, so that older calls count less.
class Durations {
public:
    void add(std::int64_t us)
    {
        ++counts_[class_of(static_cast<std::uint64_t>(std::clamp<std::int64_t>(us, 0, longest_us)))];
        if (++total_ < remembered)
            return;
        total_ = 0;
        for (auto& count : counts_)
            total_ += count /= 2;
    }

    /// The upper limit of the class with the 99th percentile; 0: no calls yet.
    [[nodiscard]] std::int64_t p99_us() const
    {
        std::uint32_t above = 0;
        for (std::size_t i = classes; i-- > 0;)
            if (above += counts_[i]; above > total_ / 100)
                return upper_limit(i);
        return 0;
    }

private:
    static constexpr int bits = 3;  // after the highest bit of a duration, that its class keeps
    static constexpr std::uint64_t per_doubling = 1U << bits;
    static constexpr std::uint32_t remembered = 2000;
    static constexpr std::int64_t longest_us = (std::int64_t{1} << 35) - 1;  // 9 h
    static constexpr std::size_t classes = (35 - bits + 1) * per_doubling;

    /// Up to 15 us each duration has its own class.
    static std::size_t class_of(std::uint64_t us)
    {
        const int shift = std::max(0, static_cast<int>(std::bit_width(us)) - bits - 1);
        return static_cast<std::size_t>(static_cast<std::uint64_t>(shift) * per_doubling + (us >> shift));
    }
    static std::int64_t upper_limit(std::size_t number)
    {
        const auto shift = std::max<std::uint64_t>(1, number / per_doubling) - 1;
        return static_cast<std::int64_t>(((number - shift * per_doubling + 1) << shift) - 1);
    }

    std::array<std::uint32_t, classes> counts_{};
    std::uint32_t total_ = 0;
};

}  // namespace hive::service
