// Delays between attempts to reach a peer that does not answer.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace hive {

/// Delays that double from `first` to `most`.
class Backoff {
public:
    Backoff(std::chrono::milliseconds first, std::chrono::milliseconds most) : first_(first), most_(most) {}
    /// Each is ±50 % at random, so that many peers that wait for one do not retry at the same time.
    Backoff(std::chrono::milliseconds first, std::chrono::milliseconds most, std::uint32_t seed)
        : first_(first), most_(most), state_(seed ? seed : 0x9e3779b9U)  // xorshift never leaves zero
    {
    }

    std::chrono::milliseconds next()
    {
        constexpr int doublings = 20;  // beyond every useful `most`, below overflow
        const auto pause = std::min(most_, first_ * (std::int64_t{1} << std::min(attempt_, doublings)));
        attempt_ = std::min(attempt_ + 1, doublings);
        return state_ == 0 ? pause : pause * percent() / 100;
    }
    void reset() noexcept { attempt_ = 0; }

private:
    /// 50 to 150.
    std::int64_t percent()
    {
        state_ ^= state_ << 13;
        state_ ^= state_ >> 17;
        state_ ^= state_ << 5;
        return 50 + state_ % 101;
    }

    std::chrono::milliseconds first_, most_;
    std::uint32_t state_ = 0;  ///< of the random numbers; 0: none
    int attempt_ = 0;
};

}  // namespace hive
