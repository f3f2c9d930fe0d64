// The pauses between attempts to reach a peer.
#include <hive/transport/transport.hpp>

#include <algorithm>

namespace hive::transport {

Backoff::Backoff(std::chrono::milliseconds first, std::chrono::milliseconds most, std::uint32_t seed)
    : first_(first), most_(most), state_(seed ? seed : 0x9e3779b9U)  // xorshift never leaves zero
{
}

std::chrono::milliseconds Backoff::next()
{
    constexpr int doublings = 20;  // beyond every useful `most`, below overflow
    const auto pause = std::min(most_, first_ * (std::int64_t{1} << std::min(attempt_, doublings)));
    attempt_ = std::min(attempt_ + 1, doublings);
    state_ ^= state_ << 13;
    state_ ^= state_ >> 17;
    state_ ^= state_ << 5;
    const std::int64_t percent = 50 + state_ % 101;
    return pause * percent / 100;
}

}  // namespace hive::transport
